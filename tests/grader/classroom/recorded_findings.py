"""How every mistake of an exercise failed when it was graded: read from and written to `recorded/EXERCISE.json`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from grader.checking.verdict import Finding
from grader.classroom.misconceptions import Failure, failure_of

FOLDER = Path(__file__).parent / "recorded"


@dataclass(frozen=True)
class Recorded:
    """One mistake. `findings` are text, expected value and actual value, by check; `blocked` was not judged."""

    name: str
    outcome: str
    findings: dict[str, tuple[str, str, str]]
    blocked: tuple[str, ...]

    @property
    def failures(self) -> dict[str, Failure]:
        """The failures as the grouping sees them: nothing for a program that did not complete."""
        if self.outcome != "graded":
            return {}
        return {
            check: failure_of(Finding(text, expected=expected, got=got))
            for check, (text, expected, got) in self.findings.items()
        }


def as_json(every: Sequence[Recorded]) -> dict[str, Any]:
    """Return the content of a file, by the mistakes' names."""
    return {one.name: {"outcome": one.outcome, "findings": one.findings, "blocked": one.blocked} for one in every}


def read(exercise: str) -> list[Recorded]:
    """Return the mistakes of an exercise, in the order in which they were graded."""
    content = json.loads((FOLDER / f"{exercise}.json").read_text(encoding="utf-8"))
    return [
        Recorded(name, one["outcome"], {check: tuple(f) for check, f in one["findings"].items()}, tuple(one["blocked"]))
        for name, one in content.items()
    ]
