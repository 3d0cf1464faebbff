"""What a failed check tells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn


@dataclass(frozen=True)
class Finding:
    """What is wrong, in words for the student, and in parts where it has them.

    `at` is in seconds after the scenario's start, `message` counts the messages sent from 1.
    """

    text: str
    scenario: str = ""
    message: int | None = None
    at: float | None = None
    part: str = ""
    expected: str = ""
    got: str = ""


class Wrong(AssertionError):
    """Raised by a check that the student's node does not pass."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(finding.text)
        self.finding = finding


def fail(text: str, *, expected: object = "", got: object = "", at: float | None = None) -> NoReturn:
    """End the check: the node does not pass it. `text` tells the student why; `at` is in seconds."""
    told = text
    if expected != "" or got != "":
        told += f" Expected {expected}, got {got}."
    raise Wrong(Finding(told, at=at, expected=str(expected), got=str(got)))
