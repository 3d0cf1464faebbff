"""A parsed program whose parts can be found and changed while the rest stays the same, character by character."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import TypeVar, cast

import libcst as cst
from libcst.metadata import MetadataWrapper, ParentNodeProvider, PositionProvider

from grader.exercise.exercise import Exercise

Kind = TypeVar("Kind", bound=cst.CSTNode)


@dataclass(frozen=True)
class Change:
    """Replace `old`, which is at `where`, with `new`. `imports` are modules that `new` needs."""

    where: cst.CSTNode
    old: cst.CSTNode
    new: cst.CSTNode
    what: str
    imports: tuple[str, ...] = ()


class ParsedProgram:
    """A parsed program of an exercise. Raises `libcst.ParserSyntaxError` if the source is not valid Python."""

    def __init__(self, source: str, exercise: Exercise) -> None:
        self.source = source
        self.exercise = exercise
        wrapper = MetadataWrapper(cst.parse_module(source))
        self.module = wrapper.module
        self._parents = wrapper.resolve(ParentNodeProvider)
        self._positions = wrapper.resolve(PositionProvider)

    def nodes(self) -> Iterator[cst.CSTNode]:
        """Yield every part of the program that does something: no docstrings, imports, annotations or log lines."""
        waiting: list[cst.CSTNode] = [self.module]
        while waiting:
            node = waiting.pop()
            if not self._says_nothing(node):
                yield node
                waiting += reversed(node.children)

    def _says_nothing(self, node: cst.CSTNode) -> bool:
        if isinstance(node, (cst.Import, cst.ImportFrom, cst.Annotation, cst.Decorator)):
            return True
        if isinstance(node, cst.Expr):
            return isinstance(node.value, (cst.SimpleString, cst.ConcatenatedString)) or "get_logger" in self.text(node)
        return False

    def text(self, node: cst.CSTNode) -> str:
        """Return the node's source."""
        return self.module.code_for_node(node)

    def line(self, node: cst.CSTNode) -> int:
        """Return the node's line, counted from 1."""
        return int(self._positions[node].start.line)

    def parent(self, node: cst.CSTNode) -> cst.CSTNode | None:
        """Return the node's parent."""
        return self._parents.get(node)

    def around(self, node: cst.CSTNode, kind: type[Kind]) -> Kind | None:
        """Return the innermost part of this kind around the node."""
        above = self.parent(node)
        while above is not None and not isinstance(above, kind):
            above = self.parent(above)
        return above

    def function(self, node: cst.CSTNode) -> cst.FunctionDef | None:
        """Return the function or method around the node."""
        return self.around(node, cst.FunctionDef)

    def has_self(self, node: cst.CSTNode) -> bool:
        """Return whether `self` is defined where the node is."""
        function = self.function(node)
        return bool(function and function.params.params and function.params.params[0].name.value == "self")

    def place(self, node: cst.CSTNode) -> str:
        """Return the names of the classes and functions around the node, such as `JointVelocity.on_joints`."""
        names: list[str] = []
        above: cst.CSTNode | None = node
        while above is not None:
            if isinstance(above, (cst.FunctionDef, cst.ClassDef)):
                names.insert(0, above.name.value)
            above = self.parent(above)
        return ".".join(names)

    def callbacks(self) -> list[cst.FunctionDef]:
        """Return the functions that the program passes to subscriptions."""
        named = {
            text.rpartition(".")[2]
            for node in self.nodes()
            if isinstance(node, cst.Call) and called(node) == "create_subscription"
            for text in [self.text(argument.value) for argument in node.args]
        }
        return [node for node in self.nodes() if isinstance(node, cst.FunctionDef) and node.name.value in named]

    def instead(
        self, statement: cst.CSTNode, what: str, *new: cst.CSTNode | str, imports: tuple[str, ...] = ()
    ) -> Change:
        """Return the change that replaces `statement` with `new` statements, or removes it if `new` is empty."""
        block = self.parent(statement)
        assert isinstance(block, (cst.IndentedBlock, cst.Module))
        body: list[cst.CSTNode] = []
        for other in block.body:
            body += [parsed(item) for item in new] if other is statement else [other]
        return Change(statement, block, with_body(block, body), what, imports)

    def changed(self, change: Change) -> str:
        """Return the source with one change made."""
        result = self._with(change.old, change.new).code
        missing = [name for name in change.imports if f"import {name}\n" not in result]
        return "".join(_with_imports(result.splitlines(keepends=True), missing))

    def _with(self, old: cst.CSTNode, new: cst.CSTNode) -> cst.Module:
        """Return the module with one part replaced. libcst's `deep_replace` would also rebuild everything around it."""
        above = self.parent(old)
        while above is not None:
            old, new = above, _with_child(above, old, new)
            above = self.parent(above)
        return cast(cst.Module, new)


def _with_child(node: cst.CSTNode, old: cst.CSTNode, new: cst.CSTNode) -> cst.CSTNode:
    """Return the node with another child in place of `old`."""
    for field in fields(node):
        value = getattr(node, field.name)
        if value is old:
            return node.with_changes(**{field.name: new})
        if isinstance(value, (list, tuple)) and any(item is old for item in value):
            return node.with_changes(**{field.name: [new if item is old else item for item in value]})
    raise ValueError(f"a {type(old).__name__} is no child of this {type(node).__name__}")


def _with_imports(lines: list[str], names: list[str]) -> Iterator[str]:
    """Add lines with imports above the first import, in each of several programs."""
    missing, in_file = bool(names), any(line.startswith(("import ", "from ")) for line in lines)
    if missing and not in_file:
        yield from (f"import {name}\n" for name in names)
    for line in lines:
        if line.startswith("# file: "):
            missing = bool(names)
        if missing and in_file and line.startswith(("import ", "from ")):
            yield from (f"import {name}\n" for name in names)
            missing = False
        yield line


def parsed(statement: cst.CSTNode | str) -> cst.CSTNode:
    """Return a statement, parsed if it is given as source."""
    return cst.parse_statement(statement) if isinstance(statement, str) else statement


def expression(source: str) -> cst.BaseExpression:
    """Parse an expression, and put it in parentheses if it needs them."""
    return cst.parse_expression(source)


def with_body(block: cst.IndentedBlock | cst.Module, body: Sequence[cst.CSTNode]) -> cst.CSTNode:
    """Return the block with other statements in it; with a `pass` if there would be none."""
    return block.with_changes(body=list(body) or [cst.parse_statement("pass")])


def called(node: cst.CSTNode) -> str:
    """Return the last name of a call's function: `publish` for `self.publisher.publish(…)`; empty for anything else."""
    if not isinstance(node, cst.Call):
        return ""
    if isinstance(node.func, cst.Attribute):
        return node.func.attr.value
    return node.func.value if isinstance(node.func, cst.Name) else ""


def argument(node: cst.CSTNode, position: int, keyword: str) -> cst.Arg | None:
    """Return an argument of a call, which is at this position or has this name."""
    for number, arg in enumerate(node.args if isinstance(node, cst.Call) else ()):
        if (number == position) if arg.keyword is None else (arg.keyword.value == keyword):
            return arg
    return None


def with_argument(call: cst.Call, source: str) -> cst.Call:
    """Return the call with one more argument, such as "clock=None"."""
    call_of_it = cst.parse_expression(f"f({source})")
    assert isinstance(call_of_it, cst.Call)
    comma = cst.Comma(whitespace_after=cst.SimpleWhitespace(" "))
    return call.with_changes(args=[*(arg.with_changes(comma=comma) for arg in call.args), call_of_it.args[0]])


def only_call(statement: cst.CSTNode, name: str) -> cst.Call | None:
    """Return the call if a statement is only a call of a function with this name."""
    if isinstance(statement, cst.SimpleStatementLine) and len(statement.body) == 1:
        inner = statement.body[0]
        if isinstance(inner, cst.Expr) and isinstance(inner.value, cst.Call) and called(inner.value) == name:
            return inner.value
    return None


def only_assignment(statement: cst.CSTNode) -> cst.Assign | None:
    """Return the assignment if a statement is only an assignment with one target."""
    if isinstance(statement, cst.SimpleStatementLine) and len(statement.body) == 1:
        inner = statement.body[0]
        if isinstance(inner, cst.Assign) and len(inner.targets) == 1:
            return inner
    return None
