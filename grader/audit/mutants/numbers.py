"""Operators for values: arithmetic, constants, and what a node remembers from one message to the next."""

from __future__ import annotations

from collections.abc import Iterator

import libcst as cst

from grader.audit.mutants.program import Change, ParsedProgram, called, expression, only_assignment, with_body

ARITHMETIC = {"+": ("-",), "-": ("+",), "*": ("/", "+"), "/": ("*", "//"), "//": ("/",), "%": ("*",), "**": ("*",)}

#: The nanoseconds of a second, and the numbers that they are mistaken for.
NANOSECONDS, MISTAKEN = 10**9, (10**6, 10**3)


def arithmetic(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Replace an operator: `a + b` with `a - b`, `a / b` with `a * b` and `a // b`, and so on."""
    if isinstance(node, cst.BinaryOperation):
        sign = program.text(node.operator).strip()
        for other in ARITHMETIC.get(sign, ()):
            template = expression(f"a {other} b")
            assert isinstance(template, cst.BinaryOperation)
            yield Change(node, node, node.with_changes(operator=template.operator), f"takes {other} for {sign}")


def operand(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Replace `a - b` with `b - a`, `a` alone and `b` alone."""
    if isinstance(node, cst.BinaryOperation):
        if program.text(node.operator).strip() in ("-", "/", "//", "%", "**"):
            yield Change(node, node, node.with_changes(left=node.right, right=node.left), "swaps the two sides")
        for kept, left_out in ((node.left, node.right), (node.right, node.left)):
            yield Change(node, node, kept, f"leaves out {program.text(left_out)}")


def divisor(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Replace `a / b` with `a / round(b, 1)`, or keep `b` from becoming small or large."""
    if isinstance(node, cst.BinaryOperation) and isinstance(node.operator, cst.Divide):
        if isinstance(node.right, (cst.Integer, cst.Float)) or program.text(node.right).isupper():
            return  # a constant
        text = program.text(node.right)
        for new, description in (
            (f"round({text}, 1)", f"rounds {text} to tenths"),
            (f"max({text}, 0.01)", f"takes 0.01 for a smaller {text}"),
            (f"min({text}, 1.0)", f"takes 1.0 for a larger {text}"),
        ):
            yield Change(node, node.right, expression(new), description)


def constant(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Make a number one more, one less, zero or twice as large; change a text; swap None and 0, True and False."""
    if isinstance(node, cst.Integer):
        value = node.evaluated_value
        for other in (value + 1, value - 1, 0):
            yield Change(node, node, expression(f"{other}"), f"{node.value} is {other}")
    elif isinstance(node, cst.Float):
        # Twice 0 is 0: that mutant would be equal to the solution.
        others = (f"{node.value} * 2", f"{node.value} / 2", "0.0") if node.evaluated_value else ("1.0",)
        for new in others:
            yield Change(node, node, expression(f"({new})"), f"{node.value} is {new}")
    elif isinstance(node, cst.SimpleString) and node.raw_value != "__main__":
        changed = node.with_changes(value=f"{node.value[:-1]}_x{node.value[-1]}")
        yield Change(node, node, changed, f"{node.value} is another text")
    elif isinstance(node, cst.Name) and not isinstance(program.parent(node), cst.Attribute):
        for old, new in (("True", "False"), ("False", "True"), ("None", "0")):
            if node.value == old:
                yield Change(node, node, expression(new), f"{old} is {new}")


def time_unit(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Give a second a million nanoseconds, or a thousand."""
    is_it = isinstance(node, (cst.Integer, cst.Float)) and node.evaluated_value == NANOSECONDS
    is_power = isinstance(node, cst.BinaryOperation) and program.text(node).replace(" ", "") == "10**9"
    if is_it or is_power:
        for other in MISTAKEN:
            yield Change(node, node, expression(f"{other:_}"), f"takes {other:,} for the nanoseconds of a second")


def without_call(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Replace `f(a)` with `a`, if `f` is a plain function of one value."""
    if isinstance(node, cst.Call) and len(node.args) == 1 and not node.args[0].keyword and called(node).islower():
        modules = ("math", "np", "numpy")
        is_method = isinstance(node.func, cst.Attribute) and program.text(node.func.value) not in modules
        if not is_method and not isinstance(program.parent(node), cst.Expr):
            yield Change(node, node, node.args[0].value, f"leaves out {called(node)}()")


NUMBERS = (arithmetic, operand, divisor, constant, time_unit, without_call)


def remembered(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Make what a node remembers one message too old, never renewed, too early, too much, or late."""
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


def _begins_as_dictionary(program: ParsedProgram, name: str) -> bool:
    for node in program.nodes():
        function = program.function(node)
        begins = isinstance(node, cst.Assign) and function is not None and function.name.value == "__init__"
        if begins and isinstance(node, cst.Assign) and program.text(node.targets[0].target) == name:
            return isinstance(node.value, cst.Dict)
    return False


def _elsewhere(node: cst.CSTNode, program: ParsedProgram, name: str) -> Iterator[Change]:
    """Move the statement into the `if` above it, and above that `if`."""
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


HISTORY = (remembered,)
