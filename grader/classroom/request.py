"""What an instructor requests, and the result for each submission."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from grader.grading.grade import Grade, Options, Outcome
from grader.grading.reference import versions
from grader.grading.scenario_runner import ScenarioRunner
from grader.submission.submission import Submission


@dataclass(frozen=True)
class ClassRequest:
    """A class to grade: where the submissions are, where to write the results, and how.

    `jobs` is how many submissions are graded at once (None: as many as suit this machine). `format` is the name of a
    format, empty for the one that fits; `attempts` is which attempt counts: "last", "first" or "best". `roster` and
    `groups` are CSV files. With `skip`, what needs a decision is not graded, and the rest is. `regrade` names
    students whose submissions are graded again even if nothing has changed, `*` all of them. `overrides` is a CSV file,
    `scheduler` a Dask scheduler's address. `rejudge` requests new verdicts on stored recordings, and `replace` stores
    them without asking. `publish` requests one zip per student.
    """

    source: Path
    out: Path
    options: Options
    jobs: int | None = None
    format: str = ""
    attempts: str | None = None
    roster: Path | None = None
    groups: Path | None = None
    skip: bool = False
    regrade: tuple[str, ...] = ()
    overrides: Path | None = None
    scheduler: str = ""
    rejudge: bool = False
    replace: bool = False
    publish: bool = False


@dataclass(frozen=True)
class GradedSubmission:
    """One submission's grade and plot. `who` is its key in `Backend.grade`."""

    who: str
    grade: Grade
    plot: str | None


class NoCluster(Exception):
    """Raised if the cluster can't be used; the text tells the instructor why."""


class ClusterLost(Exception):
    """Raised if the scheduler is gone while a class is graded; the text tells the instructor."""


class Backend(Protocol):
    """Grades submissions in parallel."""

    @property
    def key(self) -> str:
        """A key of everything that a grade depends on, except the submission."""

    def grade(self, submissions: Mapping[str, Submission]) -> Iterator[GradedSubmission]:
        """Yield the grade of each submission as soon as it is done.

        A fault of ours or the machine's is a grade with the outcome `host-error`; nothing is raised for a single
        submission. When the iterator is closed, gradings in progress are abandoned.
        """


def host_error(runner: ScenarioRunner, submission: Submission, text: str) -> Grade:
    """Return the grade without a score; `text` is for the instructor."""
    grade = no_grade(runner, "host-error", f"This is not your fault: {text}")
    return replace(grade, submission=submission.name, digest=submission.digest)


def no_grade(runner: ScenarioRunner, outcome: Outcome, message: str) -> Grade:
    """Return the grade of a student without a program that was run."""
    return Grade(
        exercise=runner.exercise.name,
        submission="",
        digest=hashlib.sha256().hexdigest(),
        outcome=outcome,
        message=message,
        score=0.0,
        points=runner.exercise.points,
        verdicts=(),
        isolation=str(runner.isolation),
        seed=runner.options.seed,
        versions=versions(),
    )
