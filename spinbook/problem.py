"""The exception of the generator: every problem that stopped the work."""

from __future__ import annotations

from groundwork.problem import AuthorError


class SpinbookError(AuthorError):
    """Raised if the work can't continue, with every problem that stopped it."""
