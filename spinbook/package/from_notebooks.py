"""Reads a package's modules out of notebooks: what a student has, who got no chapters."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from interface_compiler.definition import Definition
from spinbook.chapter.fence import interface_path
from spinbook.chapter.joining import join
from spinbook.chapter.python_code import CodeError
from spinbook.course.course import Package
from spinbook.package.files import Module
from spinbook.problem import Problem, SpinbookError


@dataclass
class Notebooks:
    """What the cells of notebooks make: a package, its modules by name, and definitions of interfaces by path."""

    package: Package | None = None
    modules: dict[str, Module] = field(default_factory=dict)
    definitions: dict[str, Definition] = field(default_factory=dict)
    code: dict[str, str] = field(default_factory=dict)
    """The code of each `%%node` and `%%part`, by its name: what `--after` refers to."""


def read_notebooks(folder: Path) -> Notebooks:
    """Read every notebook of a folder, in order of names. Raises SpinbookError where none is a chapter's."""
    read = Notebooks()
    for file in sorted(folder.glob("*.ipynb")):
        read.code.clear()
        for source in _sources(file):
            _take(read, source, file)
    if read.package is None:
        found = "there is no course.toml and no notebook of a course here."
        raise SpinbookError(Problem(folder, None, found, "Go into a course's folder, or into a handout's."))
    return read


def _sources(file: Path) -> Iterator[str]:
    """Yield the code cells of a notebook. Raises SpinbookError."""
    try:
        cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
        sources = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        found = f"it is not a valid notebook: {type(error).__name__}: {error}."
        raise SpinbookError(Problem(file, None, found, "Save it again in JupyterLab.")) from None
    yield from (source if isinstance(source, str) else "".join(source) for source in sources)


def _take(read: Notebooks, source: str, file: Path) -> None:
    for line in source.split("\n"):
        if line.startswith("%chapter "):
            read.package = _package(_words(line))
    first, _, code = source.partition("\n")
    words = _words(first)
    if len(words) < 2:
        return
    name = words[1].removesuffix(".py")
    if words[0] == "%%part":
        read.code[name] = code
    elif words[0] == "%%interface" and read.package:
        _take_interface(read, words[1], code, file)
    elif words[0] == "%%node":
        read.code[name] = code
        read.modules[name] = _module(name, words, code, read)


def _package(words: Sequence[str]) -> Package:
    given = dict(pairwise(words))
    return Package(given.get("--package", "notebook_nodes"), given.get("--workspace", "notebook_ws"))


def _take_interface(read: Notebooks, title: str, text: str, file: Path) -> None:
    assert read.package is not None
    path = interface_path(title, f"{read.package.name}_interfaces")
    if path is not None:
        package, kind, name = path.split("/")
        body = text.rstrip("\n") + "\n" if text.strip() else ""
        read.definitions[path] = Definition(package, kind, name.rpartition(".")[0], body, file)


def _module(name: str, words: Sequence[str], code: str, read: Notebooks) -> Module:
    """Return the module of a `%%node` cell, whole: with what `--after` and `--usual-imports` stand for."""
    options = _options(words[2:])
    whole = code
    if "--after" in options or "--usual-imports" in options:
        pieces = [read.code[piece] for piece in options.get("--after", ()) if piece in read.code]
        try:
            whole = join(code, pieces).whole
        except CodeError:
            whole = code  # Python says best itself what is wrong.
    pairs = [known.partition("/") for known in options.get("--as", ())]
    own = read.package.name if read.package else ""
    executables = tuple(executable for package, _, executable in pairs if package == own)
    return Module(name, whole.rstrip("\n") + "\n", executables)


def _options(words: Sequence[str]) -> dict[str, list[str]]:
    """Return the values of each option; an option given twice has the values of both."""
    options: dict[str, list[str]] = {}
    name = ""
    for word in words:
        if word.startswith("--"):
            name = word
            options.setdefault(name, [])
        else:
            options.setdefault(name, []).append(word)
    return options


def _words(line: str) -> list[str]:
    try:
        return shlex.split(line)
    except ValueError:
        return line.split()
