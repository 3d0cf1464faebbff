"""A mutant as plain data."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """A program that differs from a right one by one change.

    `id` names the change: it stays the same as long as the changed lines and the function around them do. `operator`
    is the kind of change, `what` says it in words, `line` is where, counted from 1. `source` is the whole program,
    `diff` the change as a unified diff.
    """

    id: str
    operator: str
    what: str
    line: int
    source: str
    diff: str
