"""The page of a whole course: every student's points in every exercise, and what the class struggles with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from urllib.parse import quote

from grader.gradebook.course import CourseRow, GradedExercise
from grader.overview.distribution import Distribution, distribution
from grader.overview.rows import OUTCOMES, Tally, tallies
from grader.pages.rendering import render

#: How many checks are shown that the class struggles with.
MOST_SHOWN = 10


@dataclass(frozen=True)
class Column:
    """One exercise: how many handed in, how they did on average, and how many have full marks."""

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
    """The page `results/index.html` of a course, one HTML file.

    Its links lead to `EXERCISE/index.html` and `EXERCISE/STUDENT/feedback.html` next to it.
    """
    columns = [column_of(exercise) for exercise in exercises]
    return render(
        "overview/course.html",
        script=_script(),
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
    """What the page says of one exercise."""
    finals = [entry.final for entry in exercise.entries.values() if entry.final is not None]
    return Column(
        exercise=exercise,
        page=f"{quote(exercise.name, safe='')}/index.html",
        handed_in=len(exercise.entries),
        mean=sum(finals) / len(finals) if finals else 0.0,
        full=sum(final >= exercise.points for final in finals),
    )


def points_so_far(exercises: Sequence[GradedExercise], rows: Sequence[CourseRow]) -> Distribution | None:
    """How the class's points so far are spread."""
    most = sum(exercise.points for exercise in exercises)
    return distribution([row.earned for row in rows], most) if most else None


def struggles(columns: Sequence[Column]) -> tuple[Struggle, ...]:
    """The checks of all exercises that the largest part of those who were graded fail, worst first."""
    found = [Struggle(column, tally) for column in columns for tally in tallies(list(column.exercise.entries.values()))]
    return tuple(sorted(found, key=lambda one: -one.tally.share)[:MOST_SHOWN])


def feedback_of(exercise: GradedExercise, row: CourseRow) -> str:
    """Where a student's page for an exercise is, as seen from the course's."""
    return f"{quote(exercise.name, safe='')}/{quote(row.student.id, safe='')}/feedback.html"


@cache
def _script() -> str:
    return (Path(__file__).parent / "sort.js").read_text(encoding="utf-8")
