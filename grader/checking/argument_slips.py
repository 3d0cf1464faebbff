"""Finds arguments of a helper that can't be right: too few, too many, or a text where a number belongs."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Iterator
from typing import Any

#: What Python calls an argument's type -> the types of literals that may stand there, and an example.
_FITTING: dict[str, tuple[tuple[type, ...], str]] = {
    "float": ((int, float), "0.5"),
    "int": ((int,), "2"),
    "str": ((str,), '"/out"'),
    "bool": ((bool,), "True"),
    "None": ((type(None),), ""),
    "Place": ((dict,), '{"x": 1.0}'),
    "dict[str, str]": ((dict,), '{"pose.x": "x"}'),
    "Errors": ((list, tuple), "[(0.0, 2.0)]"),
    "Kind": ((str,), '"publisher"'),
    "By": ((str,), '"node"'),
}

_LISTS: dict[type[ast.expr], type] = {ast.Dict: dict, ast.List: list, ast.Tuple: tuple, ast.JoinedStr: str}


def argument_slips(name: str, function: Callable[..., Any], call: ast.Call) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with the arguments of a call of a run's method, and what to do."""
    if is_unpacked(call):
        return
    signature = inspect.signature(function)
    try:
        bound = signature.bind(None, *call.args, **{str(keyword.arg): keyword.value for keyword in call.keywords})
    except TypeError as error:
        takes = ", ".join(_shown(parameter) for parameter in list(signature.parameters.values())[1:])
        yield f"{name}: {error}", f"It is {name}({takes})."
        return
    for key, argument in bound.arguments.items():
        annotation = str(signature.parameters[key].annotation)
        for node in argument if isinstance(argument, tuple) else (argument,):
            if isinstance(node, ast.expr) and (fix := _misfit(annotation, node)):
                yield f"{name} gets {ast.unparse(node)} for {key}", fix


def is_unpacked(call: ast.Call) -> bool:
    """Return whether a call has `*list` or `**dictionary`, so that the source does not say what it passes."""
    return any(isinstance(value, ast.Starred) for value in call.args) or any(
        keyword.arg is None for keyword in call.keywords
    )


def _shown(one: inspect.Parameter) -> str:
    if one.kind is one.VAR_POSITIONAL:
        return f"*{one.name}"
    return one.name if one.default is one.empty else f"{one.name}=…"


def _misfit(annotation: str, node: ast.expr) -> str:
    """Return what to write instead of a literal that does not fit; "" for one that fits, and what is no literal."""
    kind = _kind_of(node)
    fitting = [_FITTING.get(word.strip()) for word in annotation.split("|")]
    if kind is None or not all(fitting):
        return ""
    known = [one for one in fitting if one]
    if any(kind in types for types, _ in known):
        return ""
    return f"Write for example {' or '.join(example for _, example in known if example)}."


def _kind_of(node: ast.expr) -> type | None:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node = node.operand
    return type(node.value) if isinstance(node, ast.Constant) else _LISTS.get(type(node))
