"""Operators for what a node remembers from one message to the next."""

from __future__ import annotations

from collections.abc import Iterator

import libcst as cst

from grader.audit.mutants.program import Change, Program, only_assignment, with_body


def remembered(node: cst.CSTNode, program: Program) -> Iterator[Change]:
    """What is remembered is one message too old, never renewed, too early, too much, or only after publishing."""
    assignment = only_assignment(node)
    function = program.function(node)
    if assignment is None or function is None or function.name.value == "__init__":
        return
    name, value = program.text(assignment.targets[0].target), program.text(assignment.value)
    if not name.removeprefix("self.").isidentifier() or not name.startswith("self."):
        return
    older = f"{name}_older"
    yield program.instead(
        node, f"{name} is one message too old", f"{name} = getattr(self, '{older[5:]}', {name})", f"{older} = {value}"
    )
    yield program.instead(node, f"{name} is only set once", f"{name} = {name} or {value}")
    if _begins_as_dictionary(program, name):
        yield program.instead(node, f"{name} forgets nothing", f"{name} = {{**{name}, **{value}}}")
    yield from _elsewhere(node, program, name)


def _begins_as_dictionary(program: Program, name: str) -> bool:
    for node in program.nodes():
        function = program.function(node)
        begins = isinstance(node, cst.Assign) and function is not None and function.name.value == "__init__"
        if begins and isinstance(node, cst.Assign) and program.text(node.targets[0].target) == name:
            return isinstance(node.value, cst.Dict)
    return False


def _elsewhere(node: cst.CSTNode, program: Program, name: str) -> Iterator[Change]:
    """The statement in the `if` above it, and above that `if`."""
    block = program.parent(node)
    if not isinstance(block, cst.IndentedBlock):
        return
    body = list(block.body)
    i = body.index(node)  # type: ignore[arg-type]
    before = [k for k in range(i) if isinstance(body[k], cst.If)]
    if not before:
        return
    k = before[-1]
    guard = body[k]
    assert isinstance(guard, cst.If)
    if isinstance(guard.body, cst.IndentedBlock):
        inside = guard.with_changes(body=with_body(guard.body, [*guard.body.body, node]))
        rest = [*body[:k], inside, *body[k + 1 : i], *body[i + 1 :]]
        yield Change(node, block, with_body(block, rest), f"renews {name} only under the if")
    early = [*body[:k], node, guard, *body[k + 1 : i], *body[i + 1 :]]
    yield Change(node, block, with_body(block, early), f"renews {name} before it is used")


OPERATORS = (remembered,)
