"""How to grade one submission, and the resulting grade."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from datetime import datetime
from typing import Literal

from grader.checking.verdict import Verdict
from grader.recording.recording import Recording
from grader.sandbox.program import Isolation, Limits

#: What happened. `host-error` is not the student's fault: there is no score, and the submission must be graded again.
#: `missing`: the student handed in nothing. `undecided`: the instructor must say which submission counts.
Outcome = Literal["graded", "did-not-start", "crashed", "timed-out", "over-limit", "host-error", "missing", "undecided"]


@dataclass(frozen=True)
class Grade:
    """One grading. Two gradings of one submission are equal, because timings and logs do not count.

    `message` says to the student, or for a host error to the instructor, what happened. `line` is the line of the
    student's file that is to blame, if known. `recordings` and `references` are what the node and the solution
    published, by scenario.

    A `self_check` judges by the public checks only, and is not the official grade. `hidden_checks` and `hidden_points`
    are the number of hidden checks, and the points that they give together.
    """

    exercise: str
    submission: str
    digest: str
    outcome: Outcome
    message: str
    score: float
    points: float
    verdicts: tuple[Verdict, ...]
    isolation: str
    seed: int
    versions: dict[str, str]
    self_check: bool = False
    hidden_checks: int = 0
    hidden_points: float = 0.0
    line: int | None = None
    log: str = field(default="", compare=False, repr=False)
    seconds: float = field(default=0.0, compare=False)
    recordings: dict[str, Recording] = field(default_factory=dict, compare=False, repr=False)
    references: dict[str, Recording] = field(default_factory=dict, compare=False, repr=False)

    @property
    def has_score(self) -> bool:
        """Return whether there is a score: after a fault of ours, or before a decision, there is none."""
        return self.outcome not in ("host-error", "undecided")

    @property
    def full_marks(self) -> bool:
        """Return whether no points are missing."""
        return self.outcome == "graded" and self.score == self.points


@dataclass(frozen=True)
class Options:
    """How to grade. `isolation` None means the strongest that works here.

    `seed` chooses the numbers of scenarios with random parts. `pace` is 1.0 for real time, None for as fast as
    possible.

    `parallel` is the number of scenarios that run at once. It is higher than the number of cores, since much of a run
    is waiting. `core` is the CPU that runs the program; None lets its runs take turns on all of them.
    """

    isolation: Isolation | None = None
    seed: int = 1
    pace: float | None = None
    parallel: int = field(default_factory=lambda: max(2, min(8, 2 * len(os.sched_getaffinity(0)))))
    limits: Limits = field(default_factory=Limits)
    core: int | None = None


@dataclass(frozen=True)
class Student:
    """The person whose submission it is.

    `id` is unique in the class and names the student's folder. `lms` keeps the values of a learning platform's export
    for the student, by the platform's own column names, so that grades can be imported there.
    """

    id: str
    name: str = ""
    email: str = ""
    lms: dict[str, str] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Adjustment:
    """Points that were added after grading (or subtracted, below zero), and why."""

    kind: Literal["late", "override", "extra"]
    points: float
    reason: str


@dataclass(frozen=True)
class Entry:
    """One student's submission, its grade, and what happened to the score.

    `file` is what was graded, relative to the class's folder. `submitted` is when it was submitted, with a time zone,
    if known. `submitted_from` is the source of that time: "timestamp.txt", "the CSV file", "the file's date" or the
    platform. A grade that was read back from results has no recordings.
    """

    student: Student
    file: str
    grade: Grade
    submitted: datetime | None = None
    adjustments: tuple[Adjustment, ...] = ()
    submitted_from: str = ""

    @property
    def final(self) -> float | None:
        """Return the points that count, at least 0; with extra credit, more than the exercise's. None if there is no
        score.
        """
        if not self.grade.has_score and not any(a.kind == "override" for a in self.adjustments):
            return None
        return max(0.0, self.grade.score + sum(adjustment.points for adjustment in self.adjustments))


@dataclass(frozen=True)
class SkippedFile:
    """A file that was not graded, and why."""

    file: str
    why: str
