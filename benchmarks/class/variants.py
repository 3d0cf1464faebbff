"""The same program in other words, as another student would hand it in: other names, other spacing, other comments."""

from __future__ import annotations

import ast
import json
import random
from typing import Any

from grader.submission.upload import pack

SYNONYMS = ("current", "value", "item", "data", "last", "thing", "entry", "temp", "x1", "info", "this", "old", "elem")


def reworded(source: str, student: str, chance: random.Random) -> str:
    """`source` with its local variables renamed, laid out anew, signed by the student. It does just the same."""
    tree = ast.parse(source)
    local = sorted(_local_names(tree))
    chosen = chance.sample(local, k=chance.randint(0, len(local)))
    new = {name: f"{chance.choice(SYNONYMS)}_{number}" for number, name in enumerate(chosen)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id in new:
            node.id = new[node.id]
        elif isinstance(node, ast.arg) and node.arg in new:
            node.arg = new[node.arg]
    return f"# {student}, week {chance.randint(3, 5)}\n{ast.unparse(tree)}\n"


def _local_names(tree: ast.Module) -> set[str]:
    """Names that are bound as parameters or variables in functions, and nothing else anywhere in the module."""
    local: set[str] = set()
    other = {"self", "cls"}
    for node in ast.walk(tree):
        other |= _bound_otherwise(node)
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            local |= {part.arg for part in ast.walk(node) if isinstance(part, ast.arg)}
            local |= {p.id for p in ast.walk(node) if isinstance(p, ast.Name) and isinstance(p.ctx, ast.Store)}
    return local - other - _of_statements_outside_functions(tree)


def _bound_otherwise(node: ast.AST) -> set[str]:
    """The names that a definition, an import, a declaration, a handler or a keyword binds or uses."""
    if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.ExceptHandler)):
        return {node.name} if node.name else set()
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        return {(alias.asname or alias.name).split(".")[0] for alias in node.names}
    if isinstance(node, (ast.Global, ast.Nonlocal)):
        return set(node.names)
    return {node.arg} if isinstance(node, ast.keyword) and node.arg else set()


def _of_statements_outside_functions(tree: ast.Module) -> set[str]:
    bodies = [tree.body, *(cls.body for cls in tree.body if isinstance(cls, ast.ClassDef))]
    definitions = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    outside = [node for body in bodies for node in body if not isinstance(node, definitions)]
    return {part.id for node in outside for part in ast.walk(node) if isinstance(part, ast.Name)}


def as_notebook(source: str, stem: str) -> str:
    """The program as the exercise's cell of a notebook that has other cells, too."""
    codes = ["import math", f"%%node {stem}\n{source}", "%ros2 topic list"]
    cells: list[dict[str, Any]] = [
        {"cell_type": "code", "id": f"c{n}", "metadata": {}, "source": code, "outputs": [], "execution_count": None}
        for n, code in enumerate(codes)
    ]
    return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}, indent=1)


def as_upload(source: str, file_name: str, exercise: str) -> bytes:
    """The program in the zip that `spinbook submit` writes."""
    return pack({"exercise": exercise}, {file_name: source.encode()})
