"""Finds checks that can't fail or can't run, by their source alone."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from grader.exercise.exercise import ExerciseError

#: What one says of a comparison whose result nobody uses.
_THROWN_AWAY = (ast.Compare, ast.BoolOp)


def weak_checks(file: Path, tree: ast.Module) -> Iterator[ExerciseError]:
    """Yield what is wrong in the check functions of a file, whose parsed source is `tree`."""
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.name.startswith("test"):
            for problem, fix, line in _of_check(node):
                yield ExerciseError(file, problem, fix, line)


def _of_check(check: ast.FunctionDef | ast.AsyncFunctionDef) -> Iterator[tuple[str, str, int]]:
    parts = [node for statement in check.body for node in ast.walk(statement)]
    nested = [inner for node in parts if isinstance(node, ast.FunctionDef) for inner in ast.walk(node)]
    if isinstance(check, ast.AsyncFunctionDef):
        yield f"{check.name} is async", "Write def: when a check runs, the student's node has ended.", check.lineno
    if check.args.defaults:
        problem = f"{check.name} has a default for {check.args.args[-1].arg}, which replaces the scenario"
        yield problem, "Leave the default out: the argument is the name of a scenario.", check.lineno
    if not any(isinstance(node, (ast.Assert, ast.Raise, ast.Call, ast.Yield)) for node in parts):
        yield f"{check.name} can't fail: it calls nothing", "Call a run.must_… in it, or write assert.", check.lineno
    for node in parts:
        if isinstance(node, ast.Yield):
            yield f"{check.name} has yield, so it never runs", "Leave yield out.", node.lineno
        elif isinstance(node, ast.Return) and node.value is not None and node not in nested:
            yield (
                f"nothing uses what {check.name} returns",
                'Write assert in place of return: assert …, "…"',
                node.lineno,
            )
        elif isinstance(node, ast.Assert) and isinstance(node.test, ast.Tuple) and node.test.elts:
            yield "assert of a tuple always holds", 'Leave the parentheses out: assert …, "…"', node.lineno
        elif isinstance(node, ast.Expr) and isinstance(node.value, _THROWN_AWAY):
            yield "nothing uses the result of this comparison", 'Write assert before it: assert …, "…"', node.lineno
