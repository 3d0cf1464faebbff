"""Finds what a piece of Python defines, uses and starts, from its syntax tree: nothing is run."""

from __future__ import annotations

import ast
import builtins
import re
import symtable
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache

from grader.submission.unreadable import not_python

#: The modules that matplotlib brings.
MATPLOTLIB = ("matplotlib", "mpl_toolkits", "pylab")

#: Longer code (bytes) is not analysed, because its tree takes a hundred times as much memory.
LONGEST = 300_000

_OF_MODULES = {"__name__", "__file__", "__doc__", "__package__", "__spec__", "__loader__", "__builtins__"}

ONLY_AST = ast.PyCF_ONLY_AST


@contextmanager
def quietly() -> Iterator[None]:
    """Suppress warnings about a student's code, such as those about invalid escapes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


@lru_cache(maxsize=64)
def tree_of(code: str) -> ast.Module | None:
    """Return the syntax tree; None if the code is not valid in this Python, too long or nested too deeply."""
    try:
        encoded = code.encode()
        if len(encoded) > LONGEST or not_python(encoded.replace(b"\\\n", b"")):
            return None
        with quietly():
            return ast.parse(code)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def is_empty(code: str) -> bool:
    """Return whether the code has only comments, strings and `pass`."""
    if not any(line.strip() and not line.strip().startswith("#") for line in code.split("\n")):
        return True
    tree = tree_of(code)
    return tree is not None and all(
        isinstance(one, ast.Pass) or (isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant))
        for one in tree.body
    )


def bare(code: str) -> str:
    """Return the code without trailing blanks and without empty lines around it, for comparisons."""
    return "\n".join(line.rstrip() for line in code.replace("\r\n", "\n").split("\n")).strip()


def normalized(code: str) -> str:
    """Return a text that is equal for programs that differ only in comments and layout."""
    tree = tree_of(code)
    return ast.dump(tree) if tree else bare(code)


def defines(code: str, class_name: str) -> bool:
    """Return whether the code defines this class."""
    return bool(class_name) and bool(re.search(rf"^class\s+{re.escape(class_name)}\b", code, re.MULTILINE))


def creates(code: str, node_name: str) -> bool:
    """Return whether the code creates a node with this name."""
    name = re.escape(node_name)
    return bool(re.search(rf"""(Node|__init__|create_node)\(\s*(?:node_name\s*=\s*)?['"]{name}['"]""", code))


def bound(statements: Iterable[ast.stmt]) -> set[str]:
    """Return the names that a module's statements bind."""
    return {name for statement in statements for name in _bound_by(statement)}


def _bound_by(statement: ast.stmt) -> Iterator[str]:
    if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield statement.name
    elif isinstance(statement, ast.Import | ast.ImportFrom):
        for alias in statement.names:
            yield alias.asname or alias.name.partition(".")[0]
    elif not is_guard(statement):
        for node in ast.walk(statement):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                yield node.id
            elif isinstance(node, ast.FunctionDef | ast.ClassDef):
                yield node.name
            elif isinstance(node, ast.Import | ast.ImportFrom):
                yield from _bound_by(node)


def is_guard(statement: ast.stmt) -> bool:
    """Return whether this is `if __name__ == "__main__":`."""
    return isinstance(statement, ast.If) and any(
        isinstance(node, ast.Name) and node.id == "__name__" for node in ast.walk(statement.test)
    )


def missing(code: str) -> set[str]:
    """Return the names that the code uses but does not bind; empty if it is not valid Python."""
    if tree_of(code) is None:
        return set()
    try:
        with quietly():
            table = symtable.symtable(code, "<cell>", "exec")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    here = {symbol.get_name() for symbol in table.get_symbols() if symbol.is_assigned() or symbol.is_imported()}
    return set(_globals(table)) - here - set(dir(builtins)) - _OF_MODULES


def _globals(table: symtable.SymbolTable) -> Iterator[str]:
    tables = [table]
    while tables:
        current = tables.pop()
        for symbol in current.get_symbols():
            at_the_top = current is table and not (symbol.is_assigned() or symbol.is_imported())
            if symbol.is_referenced() and (at_the_top or symbol.is_global()):
                yield symbol.get_name()
        tables += current.get_children()


def starts(code: str) -> bool:
    """Return whether running the code starts what it defines, by a `__main__` guard, a call, or spinning."""
    tree = tree_of(code)
    if tree is None:
        return True
    own = {one.name for one in tree.body if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)} | {"main"}
    return any(is_guard(one) or (not _is_definition(one) and _starts(one, own)) for one in tree.body)


def _starts(statement: ast.stmt, own: set[str]) -> bool:
    calls = [node.func for node in ast.walk(statement) if isinstance(node, ast.Call)]
    names = [func.attr if isinstance(func, ast.Attribute) else getattr(func, "id", "") for func in calls]
    return any(name in own or name.startswith("spin") for name in names)


def _is_definition(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)


def calls_module(code: str, module: str) -> bool:
    """Return whether the code calls a function of this module at its top level, such as `rclpy.init()`."""
    tree = tree_of(code)
    effects = [one.value for one in tree.body if isinstance(one, ast.Expr)] if tree else []
    calls = [one.func for one in effects if isinstance(one, ast.Call) and isinstance(one.func, ast.Attribute)]
    return any(isinstance(call.value, ast.Name) and call.value.id == module for call in calls)


def definitions(code: str) -> set[str]:
    """Return the names that the code gives to functions, classes and values; imports do not count."""
    tree = tree_of(code)
    return bound(one for one in tree.body if not isinstance(one, ast.Import | ast.ImportFrom)) if tree else set()


def imports(code: str) -> set[str]:
    """Return the names that the code imports at its top level."""
    tree = tree_of(code)
    return bound(one for one in tree.body if isinstance(one, ast.Import | ast.ImportFrom)) if tree else set()


def imported(code: str, relative: bool = False) -> set[str]:
    """Return the modules that the code imports anywhere, with `package.name` for `from package import name`.

    With `relative`, `from .module import name` counts as `module` and `module.name`.
    """
    tree = tree_of(code)
    found: set[str] = set()
    for node in ast.walk(tree) if tree else ():
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and (relative or not node.level):
            module = node.module or ""
            found |= {module, *(f"{module}.{alias.name}".lstrip(".") for alias in node.names)} - {""}
    return found
