"""Python's syntax tree of a piece of code, parsed once however many facts are read from it."""

from __future__ import annotations

import ast
import functools
from typing import Any

_CONTEXTS = frozenset({ast.Load, ast.Store, ast.Del})
#: Enough for one chapter. A tree of 100 lines takes 0.3 MB.
_TREES = 64


@functools.lru_cache(maxsize=_TREES)
def syntax_tree(code: str) -> ast.Module:
    """Return the tree of a piece of Python, which callers must not change. Raises what `ast.parse` raises."""
    return ast.parse(code)


def parsed(code: str) -> ast.Module | None:
    """Return the tree of a piece of Python, which callers must not change; None if it is not valid Python."""
    try:
        return syntax_tree(code)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


@functools.lru_cache(maxsize=16 * _TREES)
def descendants(node: ast.AST) -> tuple[ast.AST, ...]:
    """Return a node and all those below it in the order of `ast.walk`, without `ctx`, which is no code of its own."""
    nodes = [node]
    for item in nodes:
        # Not all attributes: IPython adds each node's parent, also to `+`, of which all trees have the same one.
        for name in item._fields:
            value: Any = getattr(item, name, None)
            kind = type(value)
            if kind is list:
                nodes += [part for part in value if isinstance(part, ast.AST)]
            # Most values are places and names: comparing types is faster than isinstance.
            elif kind is not int and kind is not str and isinstance(value, ast.AST) and kind not in _CONTEXTS:
                nodes.append(value)
    return tuple(nodes)


def calls_in(node: ast.AST) -> list[ast.Call]:
    """Return the calls in a node, those nearest to its root first."""
    return [item for item in descendants(node) if isinstance(item, ast.Call)]


def keywords_of(call: ast.Call) -> dict[str, ast.expr]:
    """Return the arguments that a call gives by their names."""
    return {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}


def last_name(expression: ast.AST) -> str:
    """Return the last part of a dotted name: `Node` of `rclpy.node.Node`."""
    if isinstance(expression, ast.Attribute):
        return expression.attr
    return expression.id if isinstance(expression, ast.Name) else ""


def dotted_name(expression: ast.AST | None) -> str:
    """Return an expression that is a dotted name, such as `rclpy.spin`, as text; "" for any other."""
    if isinstance(expression, ast.Attribute):
        owner = dotted_name(expression.value)
        return owner and f"{owner}.{expression.attr}"
    return expression.id if isinstance(expression, ast.Name) else ""
