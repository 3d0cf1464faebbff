"""Whoever grades many submissions: this machine, or a cluster. Both are used in one way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

from grader.grading import Grade
from grader.submission import Submission


@dataclass(frozen=True)
class Marked:
    """One submission's grade, and the picture of it; `who` is the key under which it was given to be graded."""

    who: str
    grade: Grade
    plot: str | None


class NoCluster(Exception):
    """Raised when the cluster can't be used; tells the instructor why."""


class Markers(Protocol):
    """Grades submissions side by side."""

    @property
    def key(self) -> str:
        """The same as long as everything is that a grade depends on, beside the submission."""

    def mark(self, submissions: Mapping[str, Submission]) -> Iterator[Marked]:
        """The grade of each submission, in the order in which they are done.

        A fault of ours or a machine's is a grade with the outcome `host-error`; nothing is raised for one submission.
        When the iterator is closed, what is under way is given up.
        """
