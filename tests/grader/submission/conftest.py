"""The exercise heartbeat of the course, and one with two programs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from few_scenarios import in_scenarios

from grader.exercise import Exercise, load
from grader.exercise.exercise import ProgramFile
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="session")
def exercise() -> Exercise:
    """The exercise heartbeat, with its solution."""
    return load(ROOT / "exercises" / "heartbeat")


@pytest.fixture(scope="session")
def pair(exercise: Exercise) -> Exercise:
    """An exercise with two programs."""
    return replace(
        exercise,
        programs=(ProgramFile("counter.py", "counter", "Counter"), ProgramFile("doubler.py", "doubler", "Doubler")),
    )


@pytest.fixture(scope="session")
def grading(exercise: Exercise, workers: WorkerPool) -> Grading:
    """A grading of heartbeat in its first scenario, which shows whether a submission was read as it should be."""
    return in_scenarios(grading_of(exercise, Options(), workers))
