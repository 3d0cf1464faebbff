"""The usual mistakes in an exercise: edits of the solution in `mistakes.md`, or whole programs in `mistakes/*.py`.

Each says in its first line what is wrong, names the rule of the task that it breaks, by its id or by a sentence in
quotation marks, and names the checks that catch it. An edit says so in its section of `mistakes.md`, a whole program
in its docstring:

    It adds two.

    Breaks: “Publish twice each number.”

    Caught by: test_twice_the_number, test_zero

If it must cost more than its rule is worth, a further paragraph says why: `Costs more: nothing is published.`
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import click

from grader.exercise.edits import Edit, read_edits
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.imported_files import tree_of

#: The file of edits, and the folder of whole programs, next to solution.py.
EDITS, WHOLE = "mistakes.md", "mistakes"


@dataclass(frozen=True)
class Mistake:
    """One usual mistake, as a whole program.

    `summary` says in a sentence what is wrong. `breaks` are the rules of the task that it breaks, ids or sentences;
    most break one. `caught_by` are the checks that it names. `costs_more` is the author's reason why it may cost more
    than these rules are worth. `line`, counted from 1, is the line of `file` that names the checks.
    """

    name: str
    summary: str
    source: str
    file: Path
    line: int
    breaks: tuple[str, ...] = ()
    caught_by: tuple[str, ...] = ()
    costs_more: str = ""


class NoMistake(click.UsageError):
    """Raised when an exercise has no mistake with the requested name. The text lists its mistakes."""


def mistakes_of(exercise: Exercise) -> tuple[Mistake, ...]:
    """Return every usual mistake in an exercise, sorted by name; none in a student's copy of the course.

    Raises `ExerciseError` if an edit does not fit the solution, or two mistakes have the same name.
    """
    mistakes = {}
    for each in each_mistake(exercise):
        if isinstance(each, ExerciseError):
            raise each
        mistakes[each.name] = each
    return tuple(mistakes[name] for name in sorted(mistakes))


def each_mistake(exercise: Exercise) -> Iterator[Mistake | ExerciseError]:
    """Yield every usual mistake; for one that can't be read, yield the error instead."""
    folder = exercise.solution_folder
    if folder is None:
        return
    whole = {file.stem: file for file in sorted((folder / WHOLE).glob("*.py"))}
    for edit in _edits(folder / EDITS):
        if isinstance(edit, Edit) and edit.name in whole:
            fix = f"Remove one of them, or rename it: {whole[edit.name]}."
            yield ExerciseError(edit.file, f"there is also a whole program called {edit.name}", fix, edit.line)
        else:
            yield _of_edit(edit, folder / "solution.py") if isinstance(edit, Edit) else edit
    yield from map(_of_file, whole.values())


def mistake_of(exercise: Exercise, name: str) -> Mistake:
    """Return the mistake with this name.

    Raises `NoMistake` if there is none, and `ExerciseError` if an edit does not fit the solution.
    """
    mistakes = {mistake.name: mistake for mistake in mistakes_of(exercise)}
    if name not in mistakes:
        raise NoMistake(f"{exercise.name} has no mistake called {name}. It has: {', '.join(mistakes) or 'none'}.")
    return mistakes[name]


def _edits(file: Path) -> Iterator[Edit | ExerciseError]:
    try:
        yield from read_edits(file) if file.is_file() else ()
    except ExerciseError as error:
        yield error


def _of_edit(edit: Edit, solution: Path) -> Mistake | ExerciseError:
    try:
        return _mistake(edit.name, edit.applied_to(solution), edit.text, edit.file, edit.line)
    except ExerciseError as error:
        return error


def _of_file(file: Path) -> Mistake:
    source = file.read_text(encoding="utf-8", errors="replace")
    line = next((i for i, row in enumerate(source.splitlines(), start=1) if row.startswith("Caught by:")), 1)
    return _mistake(file.stem, source, ast.get_docstring(tree_of(source)) or "", file, line)


def _mistake(name: str, source: str, text: str, file: Path, line: int) -> Mistake:
    summary = " ".join(text.partition("\n\n")[0].split()) or name.replace("_", " ")
    breaks, more = (_paragraph(text, begin) for begin in ("Breaks", "Costs more"))
    caught_by = re.findall(r"\btest_\w+", text.partition("Caught by:")[2])
    return Mistake(name, summary, source, file, line, _rules(breaks) if breaks else (), tuple(caught_by), more)


def _paragraph(text: str, begin: str) -> str:
    """Return what follows this word and a colon, to the end of the paragraph; empty if there is no such paragraph."""
    paragraph = re.search(rf"^{begin}: *(.+?)(?:\n\n|\Z)", text, re.MULTILINE | re.DOTALL)
    return paragraph[1].strip() if paragraph else ""


def _rules(text: str) -> tuple[str, ...]:
    """Return the rules that are named after `Breaks:`: quoted sentences, or ids with commas between them."""
    if quoted := re.findall(r"“(.+?)”", text, re.DOTALL):
        return tuple(" ".join(sentence.split()) for sentence in quoted)
    if re.fullmatch(r"[a-z0-9_]+(, *[a-z0-9_]+)*", text.strip()):
        return tuple(name.strip() for name in text.split(","))
    return (" ".join(text.split()).strip("\"'"),)
