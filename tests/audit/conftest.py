"""What the audit's tests share: a small exercise, a worker pool, and what has been spun."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from quiet_audit import Auditing, Silence
from small_exercise import SmallExercise, written

from grader.audit.audit import audit
from grader.audit.result import Audit
from grader.exercise import load
from grader.grading import Options
from grader.workers import WorkerPool


@pytest.fixture(scope="session")
def workers() -> Iterator[WorkerPool]:
    """One worker for the whole session."""
    with WorkerPool() as workers:
        yield workers


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A cache of this session's own, in which one test finds what another has spun."""
    folder = tmp_path_factory.mktemp("cache")
    patch = pytest.MonkeyPatch()
    patch.setenv("SPINBOOK_CACHE", str(folder))
    yield folder
    patch.undo()


@pytest.fixture
def small(tmp_path: Path) -> SmallExercise:
    """The small exercise in a course of its own, to spoil."""
    return written(tmp_path)


@pytest.fixture(scope="session")
def audited(workers: WorkerPool, cache: Path) -> Auditing:
    """Audits a small exercise with what this session has spun already."""

    def run(small: SmallExercise, quick: bool = True, most: int = 0, seeds: int = 2) -> Audit:
        return audit(load(small.folder), Options(), workers, Silence(), quick, most, seeds)

    return run
