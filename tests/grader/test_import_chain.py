"""The longest chain of imports in spinbook/ and grader/: what has to be read, and loaded, for one module."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]

#: At most so many modules, each of which imports the next one when it is imported itself.
LONGEST = 14


@cache
def modules() -> dict[str, Path]:
    """Every module by its name, without the courses that `spinbook new` copies."""
    files = [file.relative_to(ROOT) for package in ("spinbook", "grader") for file in (ROOT / package).rglob("*.py")]
    ours = [file for file in files if not file.as_posix().startswith(("spinbook/new/kinds/", "spinbook/new/template/"))]
    return {".".join(file.with_suffix("").parts).removesuffix(".__init__"): file for file in ours}


def when_imported(statements: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield the statements that run when a module is imported: not those in functions, nor for type checkers only."""
    for statement in statements:
        if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)):
            continue
        if isinstance(statement, ast.If) and ast.unparse(statement.test) == "TYPE_CHECKING":
            continue
        yield statement
        for part in ("body", "orelse", "finalbody"):
            yield from when_imported(getattr(statement, part, ()))
        for handler in getattr(statement, "handlers", ()):
            yield from when_imported(handler.body)


def imports(name: str) -> set[str]:
    found = set()
    for statement in when_imported(ast.parse((ROOT / modules()[name]).read_text(encoding="utf-8")).body):
        if isinstance(statement, ast.Import):
            found |= {one.name for one in statement.names}
        elif isinstance(statement, ast.ImportFrom) and statement.module:
            found |= {statement.module, *(f"{statement.module}.{one.name}" for one in statement.names)}
    # `from grader.sandbox import seccomp` names a module, not what the package's __init__ offers.
    packages = {one.rpartition(".")[0] for one in found if one in modules()}
    return {one for one in found & set(modules()) if one != name and one not in packages}


@cache
def chain(name: str) -> tuple[str, ...]:
    """The longest chain that begins with this module."""
    return (name, *max((chain(one) for one in imports(name)), key=len, default=()))


def test_no_chain_of_imports_is_too_long() -> None:
    longest = max((chain(name) for name in modules()), key=len)

    assert len(longest) <= LONGEST, "\n".join(longest)
