"""The gradebook of a course, as a table and as a page: one row per student, one column per exercise."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from urllib.parse import quote

from grader.classroom.names import may_be_one, without_numbers
from grader.classroom.overview import OUTCOMES, Distribution, Tally, distribution, tallies
from grader.classroom.tables import Cell, csv_text
from grader.grading.grade import Entry, Student
from grader.report.as_json import STUDENTS, read_grade
from grader.report.pages import render


@dataclass(frozen=True)
class GradedExercise:
    """One graded exercise: `entries` by the student's id, and the `points` for full marks.

    `unreadable` are folders of students whose grade can't be read.
    """

    name: str
    title: str
    points: float
    entries: Mapping[str, Entry]
    unreadable: tuple[Path, ...] = ()


@dataclass(frozen=True)
class CourseRow:
    """One student's results: one entry per exercise, None if nothing was submitted.

    `earned` and `of` are points so far. A missing submission counts as 0 of its points; one that could not be graded
    does not count at all.
    """

    student: Student
    entries: tuple[Entry | None, ...]
    earned: float
    of: float

    @property
    def percent(self) -> float:
        """Points so far, as a percentage of those possible."""
        return 100 * self.earned / self.of if self.of else 0.0


def graded_exercises(
    results: Path, order: Sequence[str] = (), titles: Mapping[str, str] | None = None
) -> tuple[GradedExercise, ...]:
    """Return every exercise that has grades in `results/EXERCISE/students/STUDENT/grade.json`.

    Those in `order` come first, in that order; the others follow by name. A grade that can't be read is left out:
    `spinbook grade` grades that submission again.
    """
    names = {file.parents[2].name for file in results.glob(f"*/{STUDENTS}/*/grade.json")}
    ordered = [*(name for name in order if name in names), *sorted(names - set(order))]
    found = [_graded_exercise(results / name, (titles or {}).get(name, name)) for name in ordered]
    return tuple(exercise for exercise in found if exercise.entries)


def _graded_exercise(folder: Path, title: str) -> GradedExercise:
    read = {file.parent: read_grade(file) for file in sorted(folder.glob(f"{STUDENTS}/*/grade.json"))}
    entries = {stored[0].student.id: stored[0] for stored in read.values() if stored}
    points = max((entry.grade.points for entry in entries.values()), default=0.0)
    return GradedExercise(folder.name, title, points, entries, tuple(who for who, stored in read.items() if not stored))


def course_rows(exercises: Sequence[GradedExercise]) -> tuple[CourseRow, ...]:
    """Return one row per student who submitted anything, by name."""
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


def may_be_same(rows: Sequence[CourseRow]) -> Iterator[list[str]]:
    """Yield the ids of rows that may be one student's: with similar names, and no exercise in common.

    Names that differ only in numbers are one group: week1-anna, week2-anna and week3-anna. Of Participant_7 and
    Participant_8, other students handed in the same exercise, so these names say nothing.
    """
    alike: dict[frozenset[str], list[CourseRow]] = defaultdict(list)
    for row in rows:
        alike[without_numbers(row.student.id)].append(row)
    for rest, same in alike.items():
        columns = zip(*(row.entries for row in same), strict=True)
        if rest and len(same) > 1 and all(sum(map(bool, column)) < 2 for column in columns):
            yield [row.student.id for row in same]
    for one, other in combinations(rows, 2):
        mine, theirs = one.student.id, other.student.id
        apart = not any(my and its for my, its in zip(one.entries, other.entries, strict=True))
        if apart and may_be_one(mine, theirs) and not without_numbers(mine) == without_numbers(theirs) != frozenset():
            yield [mine, theirs]


def course_csv(exercises: Sequence[GradedExercise], rows: Sequence[CourseRow]) -> str:
    """Return the gradebook as CSV, with a column per exercise, the points so far, those possible, and a percentage."""
    header = ["student", "name", "email", *(exercise.name for exercise in exercises), "points so far", "of", "percent"]
    table: list[list[Cell]] = []
    for row in rows:
        points: list[Cell] = [entry.final if entry else None for entry in row.entries]
        student = row.student
        table.append([student.id, student.name, student.email, *points, row.earned, row.of, round(row.percent, 1)])
    return csv_text(header, table)


#: At most this many of the checks that students fail are shown.
MOST_SHOWN = 10


@dataclass(frozen=True)
class Column:
    """One exercise: how many students submitted, their average, and how many have full marks."""

    exercise: GradedExercise
    page: str
    handed_in: int
    mean: float
    full: int


@dataclass(frozen=True)
class Struggle:
    """A check that many students fail, and the exercise that it belongs to."""

    column: Column
    tally: Tally


def course_page(title: str, exercises: Sequence[GradedExercise], rows: Sequence[CourseRow]) -> str:
    """Return a course's page `results/index.html` as one HTML file.

    Its links lead to `EXERCISE/index.html` and `EXERCISE/students/STUDENT/feedback.html` next to it.
    """
    columns = [column_of(exercise) for exercise in exercises]
    return render(
        "classroom/course.html",
        script="classroom/sort.js",
        title=title,
        columns=columns,
        rows=rows,
        most=sum(exercise.points for exercise in exercises),
        distribution=points_so_far(exercises, rows),
        struggles=struggles(columns),
        outcomes=OUTCOMES,
        feedback_of=feedback_of,
    )


def column_of(exercise: GradedExercise) -> Column:
    """Return what the page shows for one exercise."""
    finals = [entry.final for entry in exercise.entries.values() if entry.final is not None]
    return Column(
        exercise=exercise,
        page=f"{quote(exercise.name, safe='')}/index.html",
        handed_in=sum(entry.grade.outcome != "missing" for entry in exercise.entries.values()),
        mean=sum(finals) / len(finals) if finals else 0.0,
        full=sum(final >= exercise.points for final in finals),
    )


def points_so_far(exercises: Sequence[GradedExercise], rows: Sequence[CourseRow]) -> Distribution | None:
    """Return the distribution of the class's points so far."""
    most = sum(exercise.points for exercise in exercises)
    return distribution([row.earned for row in rows], most) if most else None


def struggles(columns: Sequence[Column]) -> tuple[Struggle, ...]:
    """Return the most often failed checks of all exercises, worst first, by the share of graded students who fail."""
    found = [Struggle(column, tally) for column in columns for tally in tallies(list(column.exercise.entries.values()))]
    return tuple(sorted(found, key=lambda one: -one.tally.share)[:MOST_SHOWN])


def feedback_of(exercise: GradedExercise, row: CourseRow) -> str:
    """Return the link from the course's page to a student's page for an exercise."""
    return f"{quote(exercise.name, safe='')}/{STUDENTS}/{quote(row.student.id, safe='')}/feedback.html"
