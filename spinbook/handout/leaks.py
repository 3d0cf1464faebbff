"""Looks through a handout for what must not be in it, whatever way it may have got there."""

from __future__ import annotations

import ast
import io
import json
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from grader.exercise import Exercise
from grader.exercise.starter import BEGIN, END

#: So many lines of a solution, with so many characters together, are no coincidence.
_LINES, _CHARACTERS = 3, 40


@dataclass(frozen=True)
class Secret:
    """A piece of text that no student may see, without spaces, and what it is."""

    what: str
    text: str


def secrets(exercise: Exercise) -> list[Secret]:
    """What of this exercise is secret: the solution between its marks, and each hidden check's name and title."""
    found = list(_hidden_checks(exercise))
    if exercise.solution_file:
        for lines in _solved(exercise.solution_file.read_text(encoding="utf-8")):
            for i in range(max(1, len(lines) - _LINES + 1)):
                text = "".join(lines[i : i + _LINES])
                if len(text) >= _CHARACTERS:
                    found.append(Secret(f"a part of the solution of {exercise.name}", text))
    return found


def leaks(files: Mapping[str, bytes], known: list[Secret]) -> Iterator[tuple[str, str]]:
    """(file, what it is) for each file in which a secret stands. Looks into notebooks, wheels and zips, too."""
    for name, content in files.items():
        text = _bare(_readable(name, content))
        for secret in known:
            if secret.text in text:
                yield name, secret.what
                break
        if name.endswith((".whl", ".zip")):
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                inner = {f"{name}/{entry}": archive.read(entry) for entry in archive.namelist()}
            yield from leaks(inner, known)


def _solved(source: str) -> Iterator[list[str]]:
    """The lines of each block between marks, without spaces."""
    block: list[str] | None = None
    for line in source.splitlines():
        if BEGIN.match(line):
            block = []
        elif END.match(line):
            yield block or []
            block = None
        elif block is not None and line.strip():
            block.append(_bare(line))


def _hidden_checks(exercise: Exercise) -> Iterator[Secret]:
    file = exercise.folder / "hidden_checks.py"
    if not file.exists():
        return
    for entry in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(entry, ast.FunctionDef) and entry.name.startswith("test"):
            what = f"the hidden check {entry.name} of {exercise.name}"
            yield Secret(what, f"def{entry.name}(")
            if title := ast.get_docstring(entry):
                yield Secret(what, _bare(title))


def _readable(name: str, content: bytes) -> str:
    """A file's text; a notebook's texts, one after the other, as they are shown."""
    text = content.decode("utf-8", errors="replace")
    if name.endswith((".ipynb", ".json")):
        try:
            return "\n".join(_texts(json.loads(text)))
        except ValueError:
            pass
    return text


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, list):
        for item in value:
            yield from _texts(item)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield str(key)
            yield from _texts(item)


def _bare(text: str) -> str:
    return re.sub(r"\s+", "", text)
