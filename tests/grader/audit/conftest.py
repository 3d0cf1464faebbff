"""What the audit's tests share: a small exercise, a worker pool, and the runs so far."""

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
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where this session's cache is."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module")
def cache(cache_folder: Path) -> Iterator[Path]:
    """A cache for this session, in which one test finds what another has run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SPINBOOK_CACHE", str(cache_folder))
        yield cache_folder


@pytest.fixture
def small(tmp_path: Path) -> SmallExercise:
    """The small exercise in a course of its own, to spoil."""
    return written(tmp_path)


@pytest.fixture(scope="module")
def audited(workers: WorkerPool, cache: Path) -> Auditing:
    """Audits a small exercise, reusing this session's runs."""

    def run(small: SmallExercise, quick: bool = True, most: int = 0, seeds: int = 2) -> Audit:
        return audit(load(small.folder), Options(), workers, Silence(), quick, most, seeds)

    return run
