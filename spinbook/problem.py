"""The exception of the generator: every problem that stopped the work."""

from __future__ import annotations

from groundwork.problem import Problem


class SpinbookError(Exception):
    """Raised if the work can't continue, with every problem that stopped it."""

    def __init__(self, *problems: Problem) -> None:
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems = problems
