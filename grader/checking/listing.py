"""Lists an exercise's checks without running them."""

from __future__ import annotations

from dataclasses import dataclass

from grader.checking.judging import run_pytest
from grader.checking.plugin import Checks
from grader.exercise import Exercise


@dataclass(frozen=True)
class Listed:
    """One check. `fixtures` are the names that it asks for, also by another fixture; scenarios are among them."""

    name: str
    points: float
    hidden: bool
    fixtures: tuple[str, ...]


def listed(exercise: Exercise, scenarios: tuple[str, ...] = ()) -> tuple[Listed, ...]:
    """Every check of the exercise, in the order in which they stand.

    With names of `scenarios`, a check that asks for another one is a fault. Raises `ExerciseError` where the files of
    checks are unusable. Imports them: call it in a process of its own.
    """
    checks = Checks(run=False)
    run_pytest(exercise, dict.fromkeys(scenarios), checks)
    return tuple(
        Listed(verdict.name, verdict.points, verdict.hidden, checks.fixtures[verdict.name])
        for verdict in checks.verdicts.values()
    )
