"""What one check says of one submission."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from grader.checking.wrong import Finding

#: `error`: the check itself broke, which is never the student's fault.
Status = Literal["passed", "failed", "blocked", "error"]


@dataclass(frozen=True)
class Verdict:
    """One check's verdict. `name` is its function, `title` its docstring.

    `finding` is there for a failed check; `blocked_by` names the checks without which a blocked one can't be judged;
    `error` tells what broke in the check, with file and line.
    """

    name: str
    title: str
    status: Status
    points: float
    hint: str = ""
    misconception: str = ""
    hidden: bool = False
    finding: Finding | None = None
    blocked_by: tuple[str, ...] = ()
    error: str = ""

    @property
    def earned(self) -> float:
        """The points it gave."""
        return self.points if self.status == "passed" else 0.0
