"""A grading for hostile programs, in a worker pool of its own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.exercise import load
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.workers import WorkerPool

EXERCISE = Path(__file__).parents[3] / "exercises" / "joint_velocity"


@pytest.fixture(scope="session")
def grading() -> Iterator[Grading]:
    """A grading that runs two scenarios at once: a second one beside each attack, and no four fork bombs."""
    with WorkerPool() as workers:
        yield grading_of(load(EXERCISE), Options(parallel=2), workers)
