"""A CSV file in which the instructor decides otherwise for single students, with a reason."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from grader.intake.handed_in import IntakeError
from grader.intake.moment import moment
from grader.intake.table import rows

NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")


class OverridesError(Exception):
    """Raised for a row with a mistake; tells the instructor which."""


@dataclass(frozen=True)
class Override:
    """One row: `points` that count in place of the score, or `added` to it; or another `due` date."""

    student: str
    reason: str
    points: float | None = None
    added: float | None = None
    due: datetime | None = None


def overrides_in(file: Path, students: set[str]) -> dict[str, tuple[Override, ...]]:
    """The rows by student, each of whom must be one of `students`.

    Columns: student, reason, and points or due. `85` are the points that count; `+5` and `-5` are added to the score.
    Raises `OverridesError`.
    """
    found: dict[str, tuple[Override, ...]] = {}
    try:
        for number, row in rows(file, ("student", "reason")):
            override = _override(row, f"{file}:{number}", students)
            found[override.student] = (*found.get(override.student, ()), override)
    except IntakeError as error:
        raise OverridesError(str(error)) from None
    return found


def _override(row: dict[str, str], place: str, students: set[str]) -> Override:
    student, points, due = row["student"], row.get("points", ""), row.get("due", "")
    if student not in students:
        raise OverridesError(f"{place}: nobody is called {student!r}. Write the name of a folder in the results.")
    if not row["reason"]:
        raise OverridesError(f"{place}: there is no reason. Write it down; the student will read it.")
    if bool(points) == bool(due):
        raise OverridesError(f"{place}: points = {points!r}, due = {due!r}. Give one of the two.")
    if due:
        date = moment(due)
        if date is None:
            raise OverridesError(f"{place}: due = {due!r}. Write it as 2026-11-22 23:59.")
        return Override(student, row["reason"], due=date)
    if not NUMBER.fullmatch(points):
        raise OverridesError(f"{place}: points = {points!r}. Write 85 for what counts, +5 or -5 for what is added.")
    if points[0] in "+-":
        return Override(student, row["reason"], added=float(points))
    return Override(student, row["reason"], points=float(points))
