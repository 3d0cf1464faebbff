"""What every test may use: its own ROS domain, a small course, a mark on its processes, a browser."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import chromium
from course_folder import CourseFolder
from fixtures import only_here as only_here
from fixtures import ros_domain as ros_domain
from hypothesis import settings
from playwright.sync_api import Browser
from process_mark import ProcessMark
from tree import PYTHONPATH, ROOT
from workers import ByPiece
from xdist.remote import Producer

from grader.exercise import load
from grader.workers import WorkerPool
from spinbook.course.course import find_course
from spinbook.interfaces.definitions import compile_course

# What is collected and imported stays to the end: looking for garbage in it would be a fifth of the time for it, in
# each of pytest-xdist's processes.
gc.disable()


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()


def pytest_configure(config: pytest.Config) -> None:
    if PYTHONPATH:
        os.environ["PYTHONPATH"] = PYTHONPATH
    # Started in a shell's background, tests would make every program that they start ignore Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    # numpy, which ROS's message classes import, starts a thread per CPU, which computes for 0.1 s before it waits: in
    # each of some thousand processes that tests start, it would take that from the others.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Hypothesis fails an example that takes longer than 200 ms, unless told otherwise: on a busy machine, many do.
    settings.register_profile("no deadline", deadline=None)
    settings.load_profile("no deadline")
    # Each run makes the solutions' recordings again, once for all its processes: the user's own cache proves nothing.
    if "PYTEST_XDIST_WORKER" not in os.environ:
        os.environ["SPINBOOK_CACHE"] = tempfile.mkdtemp(prefix="spinbook-tests-")
        config.add_cleanup(lambda: shutil.rmtree(os.environ["SPINBOOK_CACHE"], ignore_errors=True))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> ByPiece:
    return ByPiece(config, log)


@pytest.fixture(scope="session")
def course_interfaces() -> None:
    """The course's own interfaces are compiled: before, no exercise that uses them can be read.

    Reading one activates them.
    """
    compile_course(find_course(ROOT))


@pytest.fixture(scope="module")
def workers_with_interfaces(course_interfaces: None) -> Iterator[WorkerPool]:
    """A worker that was started when the course's own interfaces could be imported."""
    load(ROOT / "exercises" / "calibration")
    with WorkerPool() as workers:
        yield workers


@pytest.fixture
def temporary_files(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder that this process, and what it starts, uses for temporary files while the test runs.

    Its path is shorter than that of `tmp_path`, as sockets need it.
    """
    with tempfile.TemporaryDirectory() as folder:
        monkeypatch.setattr(tempfile, "tempdir", folder)
        monkeypatch.setenv("TMPDIR", folder)
        yield Path(folder)


@pytest.fixture
def course(tmp_path: Path) -> CourseFolder:
    """An empty course."""
    return CourseFolder(tmp_path / "course")


@pytest.fixture
def process_mark(monkeypatch: pytest.MonkeyPatch) -> ProcessMark:
    """Marks every process that the test starts."""
    return ProcessMark(monkeypatch)


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """A running Chromium; see browser.py for what to do with it."""
    with chromium() as running:
        yield running
