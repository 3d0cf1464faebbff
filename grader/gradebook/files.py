"""Writes the gradebook's files."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from grader.classroom.entry import Entry
from grader.classroom.store import folder_of
from grader.classroom.writing import write
from grader.exercise import Exercise
from grader.gradebook.junit import junit
from grader.gradebook.tables import canvas, grades, moodle, nbgrader
from grader.gradescope.results import results_json

#: Excel takes a CSV file for UTF-8 only if it begins with this. Only in the file that is for people.
BYTE_ORDER_MARK = "\ufeff"


def write_gradebook(
    results: Path, exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None
) -> tuple[Path, ...]:
    """Write a class's grades into the folder `results`, and return the files, in order of students' ids.

    `grades.csv`, `nbgrader.csv`, `canvas.csv`, `moodle.csv`, `junit.xml`, and in each student's folder `results.json`
    for Gradescope. `due` is when the work was due, which nbgrader tells. Each is written whole or not at all. Raises
    OSError when the folder can't be written.
    """
    contents = gradebook(results, exercise, entries, due)
    for file, content in contents.items():
        write(file, content)
    return tuple(contents)


def gradebook(
    results: Path, exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None
) -> dict[Path, str]:
    """Return what `write_gradebook` writes: the content of each file."""
    ordered = sorted(entries, key=lambda entry: entry.student.id)
    return {
        results / "grades.csv": BYTE_ORDER_MARK + grades(exercise, ordered),
        results / "nbgrader.csv": nbgrader(exercise, ordered, due),
        results / "canvas.csv": canvas(exercise, ordered),
        results / "moodle.csv": moodle(exercise, ordered),
        results / "junit.xml": junit(exercise, ordered),
        **{folder_of(results, entry.student.id) / "results.json": results_json(entry) for entry in ordered},
    }
