"""A student's copy of the course's exercise, and a kernel in it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from notebook_kernel import Kernel

from grader.exercise import load
from grader.workers import WorkerPool
from spinbook.handout.student_copy import exercise_files

ROOT = Path(__file__).parents[3]
SOLUTIONS = ROOT / "solutions" / "joint_velocity"

#: How many public checks the exercise has.
PUBLIC = (ROOT / "exercises" / "joint_velocity" / "checks.py").read_text(encoding="utf-8").count("\n@check(")

#: Those that count if all pass: the one of the stamp is not tested in a self-check.
COUNTED = PUBLIC - 1


@pytest.fixture(scope="session")
def workers() -> Iterator[WorkerPool]:
    """One worker for the whole session."""
    with WorkerPool() as workers:
        yield workers


@pytest.fixture(scope="session")
def handed_out(tmp_path_factory: pytest.TempPathFactory, workers: WorkerPool) -> Path:
    """A folder with exercises/joint_velocity as students have it."""
    folder = tmp_path_factory.mktemp("handout")
    exercise = folder / "exercises" / "joint_velocity"
    exercise.mkdir(parents=True)
    for name, content in exercise_files(load(ROOT / "exercises" / "joint_velocity"), workers).items():
        (exercise / name).write_bytes(content)
    return folder


@pytest.fixture(scope="module")
def kernel(handed_out: Path) -> Iterator[Kernel]:
    """A kernel in the handout's folder; cells of other tests may have run in it before."""
    kernel = Kernel(handed_out)
    yield kernel
    kernel.shut_down()


def node_cell(code: str) -> str:
    """Run the exercise's cell with this code, without waiting for it."""
    return f"%%node joint_velocity --seconds 0.1\n{code}"


def solution() -> str:
    """The author's solution."""
    return (SOLUTIONS / "solution.py").read_text(encoding="utf-8")
