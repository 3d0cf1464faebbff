"""What imports what, over all packages."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
#: Distribution -> its package, of those in packages/.
SIBLINGS = {
    tomllib.loads(file.read_text(encoding="utf-8"))["project"]["name"]: file.parent.name
    for file in sorted(ROOT.glob("packages/*/pyproject.toml"))
}
PACKAGES = {
    "spinbook": ROOT / "spinbook",
    "grader": ROOT / "grader",
    **{name: ROOT / "packages" / name / name for name in SIBLINGS.values()},
}
#: At most so many modules, each of which imports the next one.
LONGEST = 14


@cache
def modules() -> Mapping[str, Path]:
    """Every module by its name, without the courses that `spinbook new` copies."""
    found = {}
    for folder in PACKAGES.values():
        for file in folder.rglob("*.py"):
            name = ".".join(file.relative_to(folder.parent).with_suffix("").parts).removesuffix(".__init__")
            if not name.startswith(("spinbook.new.kinds", "spinbook.new.template")):
                found[name] = file
    return found


@cache
def tree(name: str) -> ast.Module:
    """The syntax tree of a module."""
    return ast.parse(modules()[name].read_text(encoding="utf-8"))


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


def named(nodes: Iterable[ast.AST]) -> set[str]:
    """The full name of every module that is imported there; also names that are no modules."""
    imported = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            imported |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            imported |= {node.module, *(f"{node.module}.{one.name}" for one in node.names)}
    return imported


def ours(imported: set[str], importer: str) -> set[str]:
    """Those that are modules of ours, and not the importer itself."""
    modules_of_ours = imported & modules().keys() - {importer}
    # `from grader.sandbox import seccomp` names a module, not what the package's __init__ offers.
    return modules_of_ours - {name.rpartition(".")[0] for name in modules_of_ours}


@cache
def anywhere(name: str) -> set[str]:
    """The modules of ours that this one imports, in its functions and for type checkers, too."""
    return ours(named(ast.walk(tree(name))), name)


@cache
def chain(name: str) -> tuple[str, ...]:
    """The longest chain that begins with this module, of modules that import the next one when they are imported."""
    imports = ours(named(when_imported(tree(name).body)), name)
    return (name, *max((chain(one) for one in imports), key=len, default=()))


def test_no_module_imports_itself_by_way_of_others_in_a_function_or_for_type_checkers_either() -> None:
    try:
        TopologicalSorter({name: anywhere(name) for name in modules()}).prepare()
    except CycleError as error:
        pytest.fail(" <- ".join(error.args[1]))


def test_no_chain_of_imports_is_too_long() -> None:
    longest = max((chain(name) for name in modules()), key=len)

    assert len(longest) <= LONGEST, "\n".join(longest)


@pytest.mark.parametrize("package", sorted(SIBLINGS.values()))
def test_a_package_imports_only_those_of_ours_that_it_declares(package: str) -> None:
    project = tomllib.loads((ROOT / "packages" / package / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = {SIBLINGS[name] for name in project.get("dependencies", ()) if name in SIBLINGS}
    own = [name for name in modules() if name.partition(".")[0] == package]
    imported = {one.partition(".")[0] for name in own for one in named(ast.walk(tree(name)))}

    assert imported & PACKAGES.keys() - {package} == declared
