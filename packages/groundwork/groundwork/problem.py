"""What is wrong in an author's file (a chapter, an exercise, a scenario, course.toml), and what to do about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import Any


class Severity(str, Enum):
    """An error stops the work; NOT_RUN says that something is shown but not run; a warning stops nothing."""

    ERROR = "error"
    NOT_RUN = "not run"
    WARNING = "warning"


@dataclass(frozen=True)
class Problem:
    """One thing to fix in one file.

    `problem` says what is there, `fix` what was expected and what to do. `line` counts from 1, and is None if it is
    about the whole file. Problems of one `group` have one cause, such as a package that is not installed: a report
    counts them. `alone` says that there is no other problem in that place.
    """

    file: Path
    line: int | None
    problem: str
    fix: str
    severity: Severity = Severity.ERROR
    group: str = ""
    alone: bool = True

    @property
    def is_error(self) -> bool:
        """Whether this stops the work."""
        return self.severity is Severity.ERROR

    @property
    def place(self) -> str:
        """The file, with the line if there is one."""
        return f"{self.file}:{self.line}" if self.line is not None else f"{self.file}"

    @property
    def plain(self) -> dict[str, Any]:
        """The problem as plain data, for JSON; `from_plain` is the inverse."""
        return {**asdict(self), "file": self.file.as_posix(), "severity": self.severity.value}

    @classmethod
    def from_plain(cls, plain: Mapping[str, Any]) -> Problem:
        """Return the problem that `plain` is of."""
        return cls(**{**plain, "file": Path(plain["file"]), "severity": Severity(plain["severity"])})

    def __str__(self) -> str:
        return f"{self.place}: {self.severity.value}: {self.problem}\n    {self.fix}"


class AuthorError(Exception):
    """Raised if an author's files keep the work from going on, with every problem that has to be fixed first."""

    def __init__(self, *problems: Problem) -> None:
        super().__init__("\n".join(map(str, problems)))
        self.problems = problems
