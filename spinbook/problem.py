"""The exception of the generator: every problem that stopped the work."""

from __future__ import annotations

from collections.abc import Iterable

from groundwork.problem import AuthorError, Problem


class SpinbookError(AuthorError):
    """Raised if the work can't continue, with every problem that stopped it."""


def refuse_errors(problems: Iterable[Problem]) -> None:
    """Raise SpinbookError with those problems that are errors, if any are."""
    if errors := [problem for problem in problems if problem.is_error]:
        raise SpinbookError(*errors)
