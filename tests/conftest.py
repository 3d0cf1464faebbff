"""What every test may use: a ROS domain of its own, a small course, a mark on the processes it starts."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from course_folder import CourseFolder
from process_mark import ProcessMark

LOOPBACK = Path(__file__).parents[1] / "spinbook" / "runtime" / "loopback.xml"


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain that no other test and no notebook on this machine uses while the test runs.

    The environment is set up for it, so that rclpy in this process and in every child uses it, on loopback only.
    """
    # Domains above 60 are the tests'; notebooks take theirs from below.
    locks = Path(tempfile.gettempdir()) / "spinbook-test-domains"
    locks.mkdir(exist_ok=True)
    for domain in range(61, 100):
        with (locks / str(domain)).open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
            monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT")
            monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", os.fspath(LOOPBACK))
            yield domain
            return
    raise RuntimeError("every ROS domain from 61 to 99 is in use by another test")


@pytest.fixture
def course(tmp_path: Path) -> CourseFolder:
    """An empty course."""
    return CourseFolder(tmp_path / "course")


@pytest.fixture
def process_mark(monkeypatch: pytest.MonkeyPatch) -> ProcessMark:
    """Marks every process that the test starts."""
    return ProcessMark(monkeypatch)
