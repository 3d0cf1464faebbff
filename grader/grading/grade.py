"""A grade: what one grading of one submission came to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from grader.checking.verdict import Verdict
from grader.recording import Recording

#: What happened, of which only `host-error` is not the student's: it is no score and has to be graded again.
Outcome = Literal["graded", "did-not-start", "crashed", "timed-out", "over-limit", "host-error"]


@dataclass(frozen=True)
class Grade:
    """One grading. Two gradings of one submission are equal: what may differ (timings, logs) does not count.

    `message` tells the student, or for a host error the instructor, what happened; `line` is the line of the student's
    file that is to blame, where known. `hold` is how the rig knew that the node had handled a message. `recordings` and
    `references` are what the node and the solution published, by scenario.

    A `self_check` judges by the public checks only, and is no grade of record; `hidden_checks` and `hidden_points` are
    how many more checks there are, and what they give together.
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
    hold: str = "none"
    line: int | None = None
    log: str = field(default="", compare=False, repr=False)
    seconds: float = field(default=0.0, compare=False)
    recordings: dict[str, Recording] = field(default_factory=dict, compare=False, repr=False)
    references: dict[str, Recording] = field(default_factory=dict, compare=False, repr=False)

    @property
    def full_marks(self) -> bool:
        """Whether nothing is missing."""
        return self.outcome == "graded" and self.score == self.points
