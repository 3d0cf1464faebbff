"""What the names of a program are bound to: variables, what loops go through, and the attributes of `self`."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence

from spinbook.chapter.syntax import descendants, last_name


def bindings(own_nodes: Sequence[ast.AST]) -> dict[str, list[ast.expr | None]]:
    """Map each name that these nodes of a function bind to the values that it gets; None for what is no plain value."""
    bound: dict[str, list[ast.expr | None]] = {}
    plain: set[int] = set()
    for item in own_nodes:
        targets: list[ast.expr] = item.targets if isinstance(item, ast.Assign) else []
        targets = [item.target] if isinstance(item, ast.AnnAssign) and item.value is not None else targets
        for target in (target for target in targets if isinstance(target, ast.Name)):
            assert isinstance(item, ast.Assign | ast.AnnAssign)
            plain.add(id(target))
            bound.setdefault(target.id, []).append(item.value)
        for each, source in _loop(item.target, item.iter) if isinstance(item, ast.For | ast.comprehension) else ():
            plain.add(id(each))
            bound.setdefault(each.id, []).append(ast.Subscript(source, ast.Constant(0)))
    for item in own_nodes:
        if isinstance(item, ast.Name) and not isinstance(item.ctx, ast.Load) and id(item) not in plain:
            bound.setdefault(item.id, []).append(None)
        elif isinstance(item, ast.Global | ast.Nonlocal):
            for name in item.names:
                bound.setdefault(name, []).append(None)
        elif isinstance(item, ast.ExceptHandler | ast.MatchAs) and item.name:
            bound.setdefault(item.name, []).append(None)
    return bound


def _loop(target: ast.expr, source: ast.expr) -> Iterator[tuple[ast.Name, ast.expr]]:
    """Yield each name that a loop binds, with the list whose elements it gets; also through `enumerate` and `zip`."""
    if isinstance(target, ast.Name):
        yield target, source
    elif isinstance(target, ast.Tuple) and isinstance(source, ast.Call):
        called: Mapping[str, Sequence[ast.expr | None]] = {"enumerate": [None, *source.args[:1]], "zip": source.args}
        for part, each in zip(target.elts, called.get(last_name(source.func), ()), strict=False):
            if each is not None:
                yield from _loop(part, each)


def attributes_of_self(everything: Sequence[ast.AST]) -> dict[tuple[str, str], list[tuple[ast.expr | None, ast.AST]]]:
    """Map (class, attribute of `self`) to the values that it gets, each with its method.

    An attribute that the program also sets on something else than `self` is not in it.
    """
    values: dict[tuple[str, str], list[tuple[ast.expr | None, ast.AST]]] = {}
    plain: set[int] = set()
    for owner in (item for item in everything if isinstance(item, ast.ClassDef)):
        for method in (item for item in owner.body if isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef)):
            for item in descendants(method):
                targets = item.targets if isinstance(item, ast.Assign) else []
                for target in targets:
                    if isinstance(target, ast.Attribute) and is_self(target.value):
                        plain.add(id(target))
                        values.setdefault((owner.name, target.attr), []).append((item.value, method))  # type: ignore[attr-defined]
    stored = (i for i in everything if isinstance(i, ast.Attribute) and isinstance(i.ctx, ast.Store | ast.Del))
    unsure = {item.attr for item in stored if id(item) not in plain}
    return {key: given for key, given in values.items() if key[1] not in unsure}


def is_self(expression: ast.expr) -> bool:
    """Return whether an expression is `self`."""
    return isinstance(expression, ast.Name) and expression.id == "self"
