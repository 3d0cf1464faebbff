"""Operators for statements, calls, conditions and loops."""

from __future__ import annotations

from collections.abc import Iterator

import libcst as cst

from grader.audit.mutants.program import Change, ParsedProgram, expression, with_body


def statement_dropped(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Leave out a statement."""
    if _does_something(node, program):
        yield program.instead(node, f"leaves out {_first_line(node, program)}")


def statement_twice(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Repeat a call, except the creation of a node: no student repeats that, and the second node replaces the first."""
    making = "super().__init__" in program.text(node)
    if _does_something(node, program) and isinstance(node, cst.SimpleStatementLine) and not making:
        inner = node.body[0]
        if isinstance(inner, (cst.Expr, cst.AugAssign)) or ".create_" in program.text(node):
            again = node.with_changes(leading_lines=[])
            yield program.instead(node, f"does {_first_line(node, program)} twice", node, again)


def statements_swapped(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Move a statement above the one before it."""
    block = program.parent(node)
    if not isinstance(node, cst.SimpleStatementLine) or not isinstance(block, cst.IndentedBlock):
        return
    body = list(block.body)
    i = body.index(node)
    if i and _does_something(node, program) and _does_something(body[i - 1], program):
        body[i - 1], body[i] = body[i], body[i - 1]
        yield Change(node, block, with_body(block, body), f"does {_first_line(node, program)} too early")


def guard_removed(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Do what is under an `if` in any case, or not at all; remove a `try` or `finally`."""
    block = program.parent(node)
    if not isinstance(block, (cst.IndentedBlock, cst.Module)):
        return
    if isinstance(node, cst.If) and "__name__" not in program.text(node.test):
        yield program.instead(node, f"leaves out what is under if {program.text(node.test)}")
    elif isinstance(node, cst.Try):
        yield program.instead(node, "does not try", *node.body.body)
        if node.finalbody:
            yield Change(node, node, _without_finally(node), "leaves out finally")


def _without_finally(node: cst.Try) -> cst.Try:
    handlers = node.handlers or [
        cst.ExceptHandler(body=cst.IndentedBlock([cst.parse_statement("raise")]), type=cst.Name("Exception"))
    ]
    return node.with_changes(finalbody=None, handlers=handlers)


def handler(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Do not catch an exception, or raise it again."""
    if isinstance(node, cst.ExceptHandler):
        if isinstance(node.type, cst.Tuple):
            for element in node.type.elements:
                rest = [program.text(other.value) for other in node.type.elements if other is not element]
                tuple_ = expression(f"({', '.join(rest)},)" if len(rest) != 1 else rest[0])
                yield Change(node, node.type, tuple_, f"does not catch {program.text(element.value)}")
        if isinstance(node.body, cst.IndentedBlock):
            raised = with_body(node.body, [cst.parse_statement("raise")])
            yield Change(node, node.body, raised, "raises again what it caught")


def argument(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Swap two arguments, or leave out a keyword argument."""
    if not isinstance(node, cst.Call):
        return
    plain = [arg for arg in node.args if arg.keyword is None and not arg.star]
    if len(plain) == 2 == len(node.args):
        swapped = [plain[0].with_changes(value=plain[1].value), plain[1].with_changes(value=plain[0].value)]
        yield Change(node, node, node.with_changes(args=swapped), "swaps the two arguments")
    for arg in node.args:
        if arg.keyword is not None:
            rest = [other for other in node.args if other is not arg]
            yield Change(node, node, node.with_changes(args=rest), f"leaves out {arg.keyword.value}=")


def result(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Make a function do nothing, or return None."""
    if isinstance(node, cst.Return) and node.value is not None:
        yield Change(node, node.value, expression("None"), f"returns None for {program.text(node.value)}")
    if isinstance(node, cst.FunctionDef) and isinstance(node.body, cst.IndentedBlock):
        body = [cst.parse_statement("return"), *node.body.body]
        yield Change(node, node.body, with_body(node.body, body), f"{node.name.value}() does nothing")


def wrong_name(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """In a calculation or a condition, use another name of the same function, or of the same object."""
    above = program.parent(node)
    if not isinstance(above, (cst.BinaryOperation, cst.Comparison, cst.ComparisonTarget, cst.Index)):
        return
    if isinstance(node, cst.Name):
        others = [] if node.value in ("None", "True", "False") else _names(program, program.function(node))
    elif isinstance(node, cst.Attribute) and program.text(node.value) == "self":
        others = _attributes(program)
    else:
        return
    for other in others:
        if other != program.text(node):
            yield Change(node, node, expression(other), f"takes {other} for {program.text(node)}")


def _names(program: ParsedProgram, function: cst.FunctionDef | None) -> list[str]:
    """Return the function's arguments and what it assigns."""
    if function is None:
        return []
    names = {param.name.value for param in function.params.params if param.name.value != "self"}
    for node in program.nodes():
        is_name = isinstance(node, cst.AssignTarget) and isinstance(node.target, cst.Name)
        if is_name and program.function(node) is function:
            names.add(program.text(node).removesuffix(" = "))
    return sorted(names)


def _attributes(program: ParsedProgram) -> list[str]:
    """Return what the object remembers: everything assigned to `self.…`, without what ROS created."""
    names: set[str] = set()
    for node in program.nodes():
        if isinstance(node, cst.Assign) and ".create_" not in program.text(node.value):
            names |= {program.text(target.target) for target in node.targets}
    return sorted(name for name in names if name.startswith("self."))


def _does_something(node: cst.CSTNode, program: ParsedProgram) -> bool:
    if not isinstance(node, (cst.SimpleStatementLine, cst.For)):
        return False
    if not isinstance(program.parent(node), (cst.IndentedBlock, cst.Module)):
        return False
    if isinstance(node, cst.For):
        return True
    inner = node.body[0]
    if isinstance(inner, cst.Expr) and isinstance(inner.value, (cst.SimpleString, cst.ConcatenatedString)):
        return False
    idle = (cst.Import, cst.ImportFrom, cst.Pass, cst.Global, cst.Nonlocal)
    return not isinstance(inner, idle) and "get_logger" not in program.text(node)


def _first_line(node: cst.CSTNode, program: ParsedProgram) -> str:
    text = program.text(node.with_changes(leading_lines=[]) if hasattr(node, "leading_lines") else node)
    return text.strip().splitlines()[0].split("  #")[0]


STATEMENTS = (
    statement_dropped,
    statement_twice,
    statements_swapped,
    guard_removed,
    handler,
    argument,
    result,
    wrong_name,
)


#: Comparison -> what replaces it: first the missed boundary, then the wrong direction.
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


def comparison(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Replace `a < b` with `a <= b`, `a > b`, `a != b`."""
    if isinstance(node, cst.Comparison) and len(node.comparisons) == 1 and "__name__" not in program.text(node):
        target = node.comparisons[0]
        sign = program.text(target.operator).strip()
        for other in COMPARISONS.get(sign, ()):
            template = expression(f"a {other} b")
            assert isinstance(template, cst.Comparison)
            new = target.with_changes(operator=template.comparisons[0].operator)
            yield Change(node, target, new, f"compares with {other} and not with {sign}")


def part_of_condition(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Replace `a and b` with `a or b`, `a` alone, `b` alone."""
    if isinstance(node, cst.BooleanOperation):
        is_and = isinstance(node.operator, cst.And)
        other = node.with_changes(operator=cst.Or() if is_and else cst.And())
        yield Change(node, node, other, "takes or for and" if is_and else "takes and for or")
        for kept, left_out in ((node.left, node.right), (node.right, node.left)):
            yield Change(node, node, kept, f"leaves {program.text(left_out)} out of the condition")


def condition(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Reverse a condition, make it always true, or make it always false."""
    if isinstance(node, (cst.If, cst.While, cst.IfExp, cst.CompIf)):
        text = program.text(node.test)
        if not (isinstance(node, cst.While) and text == "True"):
            yield Change(node, node.test, expression(f"not ({text})"), f"turns the condition {text} round")
            yield Change(node, node.test, expression("True"), f"removes the guard {text}")
            yield Change(node, node.test, expression("False"), f"never goes where {text} leads")


def without_not(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Replace `not a` with `a`."""
    if isinstance(node, cst.UnaryOperation) and isinstance(node.operator, cst.Not):
        yield Change(node, node, node.expression, "leaves out not")


CONDITIONS = (comparison, part_of_condition, condition, without_not)


TAKEN = (
    ("list({})[1:]", "leaves the first of {} out"),
    ("list({})[:-1]", "leaves the last of {} out"),
    ("reversed(list({}))", "goes through {} backwards"),
    ("sorted({})", "sorts {}"),
)


def loop(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """In a loop or a comprehension, leave out the first or the last element, go backwards, or sort."""
    if isinstance(node, (cst.For, cst.CompFor)):
        text = program.text(node.iter)
        for template, description in TAKEN:
            yield Change(node, node.iter, expression(template.format(text)), description.format(text))


def end_of_loop(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """End a loop after its first turn."""
    if isinstance(node, (cst.For, cst.While)) and isinstance(node.body, cst.IndentedBlock):
        body = [*node.body.body, cst.parse_statement("break")]
        yield Change(node, node.body, with_body(node.body, body), "ends the loop after its first turn")


LOOPS = (loop, end_of_loop)
