"""What is wrong in an author's file, told so that a person can fix it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path


class Severity(str, Enum):
    """An error stops the chapter it is in; NOT_RUN says that something is shown and not run; a warning is only told."""

    ERROR = "error"
    NOT_RUN = "not run"
    WARNING = "warning"


@dataclass(frozen=True)
class Problem:
    """One thing to fix in one file.

    `found` says what is there, `fix` what was expected and what to do. `line` counts from 1, and is None where the
    whole file is meant. Problems of one `group` have one cause, such as a package that is not installed: a report
    counts them. `alone` says that nothing else stands in the way there.
    """

    file: Path
    line: int | None
    found: str
    fix: str
    severity: Severity = Severity.ERROR
    group: str = ""
    alone: bool = True

    @property
    def is_error(self) -> bool:
        """Whether this stops the chapter."""
        return self.severity is Severity.ERROR

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}" if self.line is not None else f"{self.file}"
        return f"{place}: {self.severity.value}: {self.found}\n    {self.fix}"


class SpinbookError(Exception):
    """Raised where the work can't go on, with every problem that stopped it."""

    def __init__(self, *problems: Problem) -> None:
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems = problems
