"""A quiet way for tests to run an audit."""

from __future__ import annotations

from typing import Protocol

from small_exercise import SmallExercise

from grader.audit.result import Audit


class Silence:
    """Ignores progress."""

    def begin(self, exercise: str, total: int) -> None:
        """Print nothing."""

    def done(self) -> None:
        """Print nothing."""


class Auditing(Protocol):
    """Audits a small exercise: quickly and without mutants, unless a test asks for more."""

    def __call__(self, small: SmallExercise, quick: bool = True, most: int = 0, seeds: int = 2) -> Audit:
        """Return what was found."""
