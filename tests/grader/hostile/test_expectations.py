"""Each hostile submission says what it tries, and which grade it must get."""

from __future__ import annotations

import pytest
from submissions import ON_THE_GRADER, SUBMISSIONS

OUTCOMES = {"graded", "did-not-start", "crashed", "timed-out", "over-limit"}


def test_there_are_enough_of_them() -> None:
    assert len(SUBMISSIONS) >= 75


@pytest.mark.parametrize("name", [*SUBMISSIONS, *ON_THE_GRADER])
def test_each_says_what_it_tries_and_which_grade_it_must_get(name: str) -> None:
    program = {**SUBMISSIONS, **ON_THE_GRADER}[name]
    assert program.tries.endswith(".")
    assert set(program.outcome) <= OUTCOMES
    assert program.outcome
    assert program.score in {"zero", "full", "less", "any"}
