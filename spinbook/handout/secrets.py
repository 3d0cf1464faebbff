"""What of an exercise no student may see, as pieces of text to look for."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from grader.exercise import Exercise, starter
from grader.exercise.starter import BEGIN, END

#: One line with so many characters besides spaces is no coincidence, nor are so many lines with so many together.
_ONE_LINE = 40
_LINES, _CHARACTERS = 3, 40


@dataclass(frozen=True)
class Secret:
    """A piece of text that no student may see, without spaces, and what it is; `at` is its file and first line."""

    what: str
    text: str
    at: str = ""


#: A line's number, and the line without spaces.
Line = tuple[int, str]


def secrets(exercise: Exercise, taught: str) -> list[Secret]:
    """What of this exercise is secret: solutions, hidden checks, and what nodes are spun against.

    `taught` is code that students have from the chapters; a line of it is no secret, wherever else it stands. Nor is a
    line of the starter, or of the public checks.
    """
    public = exercise.folder / "checks.py"
    told = taught + (public.read_text(encoding="utf-8") if public.exists() else "")
    found = []
    if exercise.solution_file:
        source = exercise.solution_file.read_text(encoding="utf-8")
        told += starter(source)
        what = f"a part of the solution of {exercise.name}"
        place = f"solutions/{exercise.name}/solution.py"
        known = bare(told)
        for lines in _solved(source):
            found += _pieces(what, place, lines, known)
            found += _windows(what, place, lines)
    known = bare(told)
    if exercise.solution_folder:
        for file in sorted(exercise.solution_folder.rglob("*.py")):
            if file != exercise.solution_file:
                place = f"solutions/{exercise.name}/{file.relative_to(exercise.solution_folder).as_posix()}"
                windows = _windows(f"a part of {place}", place, _lines(file))
                found += [secret for secret in windows if secret.text not in known]
    for name in ("hidden_checks.py", "scenarios.py"):
        file = exercise.folder / name
        if file.exists():
            place = f"exercises/{exercise.name}/{name}"
            found += _pieces(f"a line of {name} of {exercise.name}", place, _lines(file), known)
    return found + list(_hidden_titles(exercise))


def hidden_names(exercise: Exercise) -> list[Secret]:
    """The names of hidden checks. Spinbook's own files may have a check of that name in an example."""
    return [Secret(_named(entry, exercise), entry.name) for entry in _hidden_checks(exercise)]


def bare(text: str) -> str:
    """A text without spaces and line ends."""
    return re.sub(r"\s+", "", text)


def _pieces(what: str, place: str, lines: list[Line], known: str) -> list[Secret]:
    long = [(number, line) for number, line in lines if len(line) >= _ONE_LINE]
    return [Secret(what, line, f"{place}:{number}") for number, line in long if line not in known]


def _windows(what: str, place: str, lines: list[Line]) -> list[Secret]:
    windows = [lines[i : i + _LINES] for i in range(max(1, len(lines) - _LINES + 1)) if lines]
    texts = [("".join(line for _, line in window), window[0][0]) for window in windows]
    return [Secret(what, text, f"{place}:{number}") for text, number in texts if len(text) >= _CHARACTERS]


def _solved(source: str) -> Iterator[list[Line]]:
    """The lines of each block between marks, without spaces."""
    block: list[Line] | None = None
    for number, line in enumerate(source.splitlines(), start=1):
        if BEGIN.match(line):
            block = []
        elif END.match(line):
            yield block or []
            block = None
        elif block is not None and line.strip():
            block.append((number, bare(line)))


def _lines(file: Path) -> list[Line]:
    """The lines of a file that say more than what it imports, without spaces."""
    lines = enumerate(file.read_text(encoding="utf-8").splitlines(), start=1)
    return [
        (number, bare(line)) for number, line in lines if line.strip() and not line.startswith(("import ", "from "))
    ]


def _hidden_titles(exercise: Exercise) -> Iterator[Secret]:
    for entry in _hidden_checks(exercise):
        at = f"exercises/{exercise.name}/hidden_checks.py:{entry.lineno}"
        yield Secret(_named(entry, exercise), f"def{entry.name}(", at)
        if title := ast.get_docstring(entry):
            yield Secret(_named(entry, exercise), bare(title), at)


def _named(check: ast.FunctionDef, exercise: Exercise) -> str:
    return f"the hidden check {check.name} of {exercise.name}"


def _hidden_checks(exercise: Exercise) -> Iterator[ast.FunctionDef]:
    file = exercise.folder / "hidden_checks.py"
    if file.exists():
        for entry in ast.parse(file.read_text(encoding="utf-8")).body:
            if isinstance(entry, ast.FunctionDef) and entry.name.startswith("test"):
                yield entry
