"""The checks that students may read, as the exercise's page lists them: titles and points, and no code."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class PublicCheck:
    """A check's title and its points."""

    title: str
    points: float


def public_checks(file: Path) -> tuple[PublicCheck, ...]:
    """The checks of an exercise's checks.py, in order. They are read, not run; () where the file can't be read."""
    try:
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (OSError, SyntaxError, UnicodeDecodeError):
        return ()
    found = (_check(node) for node in tree.body if isinstance(node, ast.FunctionDef))
    return tuple(check for check in found if check)


def _check(function: ast.FunctionDef) -> PublicCheck | None:
    for decorator in function.decorator_list:
        if not isinstance(decorator, ast.Call) or ast.unparse(decorator.func).split(".")[-1] != "check":
            continue
        points = next((word.value for word in decorator.keywords if word.arg == "points"), None)
        if isinstance(points, ast.Constant) and isinstance(points.value, (int, float)):
            title = (ast.get_docstring(function) or function.name).split("\n\n")[0]
            return PublicCheck(" ".join(title.split()), float(points.value))
    return None
