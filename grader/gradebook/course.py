"""The gradebook of a course: a row per student, a column per exercise that was graded so far."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from grader.classroom.entry import Entry, Student
from grader.classroom.store import from_json
from grader.gradebook.table import Cell, csv_text


@dataclass(frozen=True)
class GradedExercise:
    """One exercise that a class was graded for: `entries` by the student's id, `points` is full marks."""

    name: str
    title: str
    points: float
    entries: Mapping[str, Entry]


@dataclass(frozen=True)
class CourseRow:
    """One student in all exercises: `entries` has one per exercise, None where nothing was handed in.

    `earned` and `of` are points so far. One without a submission counts as 0 of its points; one that could not be
    graded counts neither way.
    """

    student: Student
    entries: tuple[Entry | None, ...]
    earned: float
    of: float

    @property
    def percent(self) -> float:
        """Points so far, in percent of those there were."""
        return 100 * self.earned / self.of if self.of else 0.0


def graded_exercises(
    results: Path, order: Sequence[str] = (), titles: Mapping[str, str] | None = None
) -> tuple[GradedExercise, ...]:
    """Every exercise that has grades in `results/EXERCISE/STUDENT/grade.json`.

    First those of `order`, in that order, then all others by name. A grade that can't be read is left out, as `spinbook
    grade` grades it again.
    """
    names = {file.parents[1].name for file in results.glob("*/*/grade.json")}
    ordered = [*(name for name in order if name in names), *sorted(names - set(order))]
    found = [_graded_exercise(results / name, (titles or {}).get(name, name)) for name in ordered]
    return tuple(exercise for exercise in found if exercise.entries)


def _graded_exercise(folder: Path, title: str) -> GradedExercise:
    read = [_entry(file) for file in sorted(folder.glob("*/grade.json"))]
    entries = {entry.student.id: entry for entry in read if entry}
    points = max((entry.grade.points for entry in entries.values()), default=0.0)
    return GradedExercise(folder.name, title, points, entries)


def _entry(file: Path) -> Entry | None:
    try:
        return from_json(file.read_text(encoding="utf-8"))[0]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def course_rows(exercises: Sequence[GradedExercise]) -> tuple[CourseRow, ...]:
    """A row per student who handed in anything, by name."""
    students: dict[str, Student] = {}
    for exercise in exercises:
        for who, entry in exercise.entries.items():
            if who not in students or not students[who].name:
                students[who] = entry.student
    rows = [_row(student, exercises) for student in students.values()]
    return tuple(sorted(rows, key=lambda row: (row.student.name or row.student.id).casefold()))


def _row(student: Student, exercises: Sequence[GradedExercise]) -> CourseRow:
    entries = tuple(exercise.entries.get(student.id) for exercise in exercises)
    counted = [
        (entry.final if entry and entry.final is not None else 0.0, exercise.points)
        for exercise, entry in zip(exercises, entries, strict=True)
        if entry is None or entry.final is not None
    ]
    return CourseRow(student, entries, sum(got for got, _ in counted), sum(most for _, most in counted))


def course_csv(exercises: Sequence[GradedExercise], rows: Sequence[CourseRow]) -> str:
    """The gradebook as CSV: student, name, email, a column per exercise, points so far, of how many, percent."""
    header = ["student", "name", "email", *(exercise.name for exercise in exercises), "points so far", "of", "percent"]
    table: list[list[Cell]] = []
    for row in rows:
        points: list[Cell] = [entry.final if entry else None for entry in row.entries]
        student = row.student
        table.append([student.id, student.name, student.email, *points, row.earned, row.of, round(row.percent, 1)])
    return csv_text(header, table)
