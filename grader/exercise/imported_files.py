"""What the Python files of an exercise import: the files next to them, which may be modules of theirs."""

from __future__ import annotations

import ast
import contextlib
import functools
import hashlib
import importlib
import importlib.util
import itertools
import sys
import traceback
from collections.abc import Iterable, Iterator
from importlib.machinery import PathFinder
from pathlib import Path
from types import ModuleType


@contextlib.contextmanager
def importable(folder: Path) -> Iterator[None]:
    """Let code import the files in `folder`, and forget them at the end: another exercise may have the same names.

    An installed module takes precedence. So a file of a student's next to the checks, such as random.py, is never
    imported in place of Python's own.
    """
    path = str(folder)
    if path in sys.path:
        yield
        return
    last = next(reversed(sys.modules))
    wrote, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    sys.path.append(path)
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.path.remove(path)
        sys.dont_write_bytecode = wrote
        # Only what was imported meanwhile: to look at another module would copy its memory in a fork.
        for name in list(itertools.takewhile(last.__ne__, reversed(sys.modules))):
            if Path(getattr(sys.modules[name], "__file__", None) or "/").parent == folder:
                del sys.modules[name]


def imported(file: Path, name: str) -> ModuleType:
    """Return a file of an exercise as a module called `name`, which may import the files next to it."""
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    with importable(file.parent):
        sys.modules[name] = module  # `inspect` and `dataclasses` look here for the file of a class
        spec.loader.exec_module(module)
    return module


@functools.lru_cache(maxsize=64)  # each file is asked for some ten times
def tree_of(source: str) -> ast.Module:
    """Return a parsed program of an author's; an empty one if it is not valid Python, which running it reports."""
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError):
        return ast.Module(body=[], type_ignores=[])


def tree_in(file: Path) -> ast.Module:
    """Return the parsed program in a file; an empty one if it can't be read or is not valid Python."""
    try:
        return tree_of(file.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError):
        return tree_of("")


def imports_of(file: Path) -> Iterator[tuple[int, str]]:
    """Yield the line and the first part of the name of each module that a Python file imports, such as `maze`."""
    for node in ast.walk(tree_in(file)):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name.partition(".")[0]) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.lineno, node.module.partition(".")[0]


def with_modules(files: Iterable[Path]) -> tuple[Path, ...]:
    """Return these files of one exercise and the files next to them that they import, directly or by way of others."""
    closure = list(dict.fromkeys(files))
    for file in closure:  # which grows meanwhile
        near = [file.parent / f"{name}.py" for _, name in imports_of(file)]
        closure += [one for one in dict.fromkeys(near) if one not in closure and one.exists() and not installed(one)]
    return tuple(closure)


def digest_with_modules(file: Path) -> str:
    """Return the SHA-256 of a file's text and of the text of the files next to it that it imports."""
    total = hashlib.sha256()
    for one in with_modules([file]):
        total.update(one.read_bytes())
    return total.hexdigest()


def installed(near: Path) -> bool:
    """Return whether Python has a module of this file's name elsewhere."""
    if near.stem in sys.stdlib_module_names:
        return True
    elsewhere = [entry for entry in sys.path if Path(entry or ".").resolve() != near.parent.resolve()]
    return PathFinder.find_spec(near.stem, elsewhere) is not None


def place_of(error: BaseException, folder: Path) -> tuple[Path, int] | None:
    """Return the innermost file and line in an exercise's folder that led to an error; None if there is none."""
    if isinstance(error, SyntaxError) and error.filename and Path(error.filename).parent == folder:
        return Path(error.filename), error.lineno or 1
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename).parent == folder]
    return (Path(frames[-1].filename), frames[-1].lineno or 1) if frames else None
