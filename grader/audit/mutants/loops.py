"""Operators for loops: one too few, the wrong order, an end too early."""

from __future__ import annotations

from collections.abc import Iterator

import libcst as cst

from grader.audit.mutants.program import Change, Program, expression, with_body

TAKEN = (
    ("list({})[1:]", "leaves the first of {} out"),
    ("list({})[:-1]", "leaves the last of {} out"),
    ("reversed(list({}))", "goes through {} backwards"),
    ("sorted({})", "sorts {}"),
)


def loop(node: cst.CSTNode, program: Program) -> Iterator[Change]:
    """A loop or a comprehension leaves out the first or the last, goes backwards, or sorts."""
    if isinstance(node, (cst.For, cst.CompFor)):
        text = program.text(node.iter)
        for template, what in TAKEN:
            yield Change(node, node.iter, expression(template.format(text)), what.format(text))


def end_of_loop(node: cst.CSTNode, program: Program) -> Iterator[Change]:
    """A loop ends after its first turn."""
    if isinstance(node, (cst.For, cst.While)) and isinstance(node.body, cst.IndentedBlock):
        body = [*node.body.body, cst.parse_statement("break")]
        yield Change(node, node.body, with_body(node.body, body), "ends the loop after its first turn")


OPERATORS = (loop, end_of_loop)
