"""A class that is shown method by method: its beginning, its methods, and how they are joined."""

from __future__ import annotations

import ast
import functools
import re
import textwrap
from collections.abc import Sequence

from spinbook.chapter.syntax import calls_in, parsed

_INDENT = " " * 4


def names_begun(code: str) -> frozenset[str]:
    """Return the classes and functions of code that ends where a block begins, as `class Talker(Node):` does."""
    lines = [line for line in code.split("\n") if line.strip() and not line.lstrip().startswith("#")]
    if not lines or not lines[-1].split("#")[0].rstrip().endswith(":"):
        return frozenset()
    margin = lines[-1][: len(lines[-1]) - len(lines[-1].lstrip())]
    tree = parsed(f"{code.rstrip()}\n{margin}{_INDENT}pass\n")
    statements = tree.body if tree else []
    return frozenset(i.name for i in statements if isinstance(i, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef))


def methods_alone(tree: ast.Module) -> frozenset[str]:
    """Return the methods of code that holds nothing else: they belong to a class which is not in it."""
    methods = set()
    for item in tree.body:
        if isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef) and [a.arg for a in item.args.args[:1]] == ["self"]:
            methods.add(item.name)
        elif not (isinstance(item, ast.Expr) and isinstance(item.value, ast.Constant)):
            return frozenset()
    return frozenset(methods)


def uses_super_outside(tree: ast.Module) -> bool:
    """Return whether code that is in no class calls `super()`."""
    calls = [call for item in tree.body if not isinstance(item, ast.ClassDef) for call in calls_in(item)]
    return any(isinstance(call.func, ast.Name) and call.func.id == "super" and not call.args for call in calls)


@functools.lru_cache(maxsize=256)
def assembled(pieces: tuple[str, ...]) -> tuple[tuple[tuple[int, ...], str], ...]:
    """Return (numbers of the pieces, their code), with each class joined to its methods in the next pieces."""
    groups: list[tuple[tuple[int, ...], str]] = []
    at = 0
    while at < len(pieces):
        numbers, text = _class_from(at, pieces)
        groups.append((numbers, text))
        at = numbers[-1] + 1
    return tuple(groups)


def _class_from(start: int, pieces: Sequence[str]) -> tuple[tuple[int, ...], str]:
    """Return the class that begins at the end of a piece, with the next pieces that continue it."""
    text, end = pieces[start], start
    if _last_at_margin(text).startswith("class "):
        grown = text
        for number in range(start + 1, len(pieces)):
            more = _as_body(pieces[number])
            grown = f"{grown.rstrip()}\n\n{more}" if more else ""
            if not grown:
                break
            if parsed(grown):
                text, end = grown, number
    return tuple(range(start, end + 1)), text


def _last_at_margin(code: str) -> str:
    return next((line for line in reversed(code.split("\n")) if line[:1].strip() not in {"", "#", ")"}), "")


def _as_body(code: str) -> str:
    """Return a piece indented as in a class: methods, or the rest of one; "" for anything else."""
    first = next((line for line in code.split("\n") if line.strip() and not line.lstrip().startswith("#")), "")
    if first[:1].isspace():
        dedented = textwrap.dedent(code)
        return textwrap.indent(dedented, _INDENT) if re.match(r"(async )?def |@", first.lstrip()) else code
    tree = parsed(code)
    return textwrap.indent(code, _INDENT) if tree and methods_alone(tree) else ""
