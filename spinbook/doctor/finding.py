"""What a check found."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class State(str, Enum):
    """How grave a finding is."""

    OK = "ok"
    """It works."""
    WARNING = "warning"
    """Something is weaker, or surprising; courses are built and graded all the same."""
    MISSING = "missing"
    """Without it courses are not built or not graded."""


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    `found` tells what is there, with versions and places. `mend` tells what to do where it is not well.
    """

    name: str
    state: State
    found: str
    mend: str = ""


def ok(name: str, found: str) -> Finding:
    """It works."""
    return Finding(name, State.OK, found)


def warning(name: str, found: str, mend: str) -> Finding:
    """It works, but not as well as it could."""
    return Finding(name, State.WARNING, found, mend)


def missing(name: str, found: str, mend: str) -> Finding:
    """Something that is needed does not work."""
    return Finding(name, State.MISSING, found, mend)
