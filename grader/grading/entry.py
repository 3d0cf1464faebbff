"""One student's row in the gradebook, as plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from typing import Literal

from grader.grading.grade import Grade


@dataclass(frozen=True)
class Student:
    """Whose submission it is.

    `id` is unique in the class and names the student's folder. `lms` keeps the values of a learning platform's export
    for the student, by the platform's own column names, so that grades can be imported there.
    """

    id: str
    name: str = ""
    email: str = ""
    lms: dict[str, str] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Adjustment:
    """Points that were added (or, below zero, taken) after grading, and why."""

    kind: Literal["late", "override", "extra"]
    points: float
    reason: str


@dataclass(frozen=True)
class Entry:
    """One student's submission, its grade, and what happened to the score.

    `file` is what was graded, relative to the class's folder. `submitted` is when it was submitted, with a time zone,
    if known, and `submitted_from` is where that comes from: "timestamp.txt", "the CSV file", "the zip file" or "the
    file's date". A grade that was read back from results has no recordings.
    """

    student: Student
    file: str
    grade: Grade
    submitted: datetime | None = None
    adjustments: tuple[Adjustment, ...] = ()
    submitted_from: str = ""

    @property
    def final(self) -> float | None:
        """The points that count, at least 0; more than the exercise's with extra credit. None for a fault of ours."""
        if self.grade.outcome == "host-error" and not any(a.kind == "override" for a in self.adjustments):
            return None
        return max(0.0, self.grade.score + sum(adjustment.points for adjustment in self.adjustments))


@dataclass(frozen=True)
class Skipped:
    """A file that was not graded, and why."""

    file: str
    why: str
