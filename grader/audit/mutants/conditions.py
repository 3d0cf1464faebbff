"""Operators for comparisons and conditions."""

from __future__ import annotations

from collections.abc import Iterator

import libcst as cst

from grader.audit.mutants.program import Change, Program, expression

#: Comparison -> what it is taken for. A boundary missed first, then a direction.
COMPARISONS = {
    "<": ("<=", ">", "!="),
    ">": (">=", "<", "!="),
    "<=": ("<", ">=", "=="),
    ">=": (">", "<=", "=="),
    "==": ("!=",),
    "!=": ("==",),
    "in": ("not in",),
    "not in": ("in",),
    "is": ("is not",),
    "is not": ("is",),
}


def comparison(node: cst.CSTNode, program: Program) -> Iterator[Change]:
    """`a < b` becomes `a <= b`, `a > b`, `a != b`."""
    if isinstance(node, cst.Comparison) and len(node.comparisons) == 1 and "__name__" not in program.text(node):
        target = node.comparisons[0]
        sign = program.text(target.operator).strip()
        for other in COMPARISONS.get(sign, ()):
            template = expression(f"a {other} b")
            assert isinstance(template, cst.Comparison)
            new = target.with_changes(operator=template.comparisons[0].operator)
            yield Change(node, target, new, f"compares with {other} and not with {sign}")


def part_of_condition(node: cst.CSTNode, program: Program) -> Iterator[Change]:
    """`a and b` becomes `a or b`, `a` alone, `b` alone."""
    if isinstance(node, cst.BooleanOperation):
        is_and = isinstance(node.operator, cst.And)
        other = node.with_changes(operator=cst.Or() if is_and else cst.And())
        yield Change(node, node, other, "takes or for and" if is_and else "takes and for or")
        for kept, left_out in ((node.left, node.right), (node.right, node.left)):
            yield Change(node, node, kept, f"leaves {program.text(left_out)} out of the condition")


def condition(node: cst.CSTNode, program: Program) -> Iterator[Change]:
    """A condition is turned round, always holds, never holds."""
    if isinstance(node, (cst.If, cst.While, cst.IfExp, cst.CompIf)):
        text = program.text(node.test)
        if not (isinstance(node, cst.While) and text == "True"):
            yield Change(node, node.test, expression(f"not ({text})"), f"turns the condition {text} round")
            yield Change(node, node.test, expression("True"), f"removes the guard {text}")
            yield Change(node, node.test, expression("False"), f"never goes where {text} leads")


def without_not(node: cst.CSTNode, program: Program) -> Iterator[Change]:
    """`not a` becomes `a`."""
    if isinstance(node, cst.UnaryOperation) and isinstance(node.operator, cst.Not):
        yield Change(node, node, node.expression, "leaves out not")


OPERATORS = (comparison, part_of_condition, condition, without_not)
