"""What the grader's tests share: the exercise, and a worker pool that is ready to grade it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.exercise import Exercise, load
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def exercise() -> Exercise:
    """The exercise joint_velocity."""
    return load(ROOT / "exercises" / "joint_velocity")


@pytest.fixture(scope="session")
def workers() -> Iterator[WorkerPool]:
    """One worker for the whole session."""
    with WorkerPool() as workers:
        yield workers


@pytest.fixture(scope="session")
def grading(exercise: Exercise, workers: WorkerPool) -> Grading:
    """A grading of joint_velocity; its solution has been verified in this run of the tests.

    It runs one scenario at a time: where the first decides, as often in test_outcomes.py, no other is begun in vain.
    Several at once, as by default, run in test_determinism.py, test_command.py and test_course_solutions.py.
    """
    return grading_of(exercise, Options(parallel=1), workers)
