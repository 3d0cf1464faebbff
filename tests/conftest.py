"""What every test may use: a ROS domain of its own, a small course, a mark on the processes it starts."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import psutil
import pytest

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


class CourseFolder:
    """A small course in a temporary folder, and what `spinbook` says when it is run there."""

    def __init__(self, root: Path) -> None:
        self.root = root
        (root / "chapters").mkdir(parents=True)

    def write(self, **chapters: str | bytes) -> CourseFolder:
        """Write chapters by name, and a course.toml that lists every chapter there is, by name."""
        for name, text in chapters.items():
            file = self.root / "chapters" / f"{name}.md"
            file.write_bytes(text if isinstance(text, bytes) else text.encode())
        names = sorted(file.name for file in (self.root / "chapters").glob("*.md"))
        listed = ", ".join(f'"chapters/{name}"' for name in names)
        (self.root / "course.toml").write_text(
            f'title = "A course"\nchapters = [{listed}]\n[package]\nname = "robot"\nworkspace = "robot_ws"\n'
        )
        return self

    def spinbook(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run the command in the course's folder."""
        return subprocess.run(
            [sys.executable, "-m", "spinbook", *words], cwd=self.root, capture_output=True, text=True, timeout=280
        )

    def notebook(self, name: str, folder: str = "notebooks") -> Any:
        """A built notebook (or an executed one)."""
        return nbformat.read(self.root / "build" / folder / f"{name}.ipynb", as_version=4)

    def outputs(self, name: str) -> dict[str, str]:
        """Cell id -> all the text that an executed chapter's cell shows, errors included."""
        return {
            cell.id: "".join(output.get("text", "") + "\n".join(output.get("traceback", [])) for output in cell.outputs)
            for cell in self.notebook(name, "executed").cells
            if cell.cell_type == "code"
        }


@pytest.fixture
def course(tmp_path: Path) -> CourseFolder:
    """An empty course."""
    return CourseFolder(tmp_path / "course")


class ProcessMark:
    """Tells the processes that come from one test from all others, by a variable in their environment."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._value = uuid.uuid4().hex
        monkeypatch.setenv("SPINBOOK_TEST_MARK", self._value)

    def alive(self) -> list[str]:
        """The command lines of those that run."""
        found = []
        for process in psutil.process_iter():
            try:
                is_ours = process.environ().get("SPINBOOK_TEST_MARK") == self._value
                if is_ours and process.pid != os.getpid() and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(" ".join(process.cmdline()))
            except psutil.Error:
                continue
        return found

    def wait_until_none(self, timeout_s: float = 20) -> None:
        """Wait until none runs any more; fails the test where one stays."""
        deadline = time.monotonic() + timeout_s
        while left := self.alive():
            assert time.monotonic() < deadline, f"left behind: {left}"
            time.sleep(0.05)


@pytest.fixture
def process_mark(monkeypatch: pytest.MonkeyPatch) -> ProcessMark:
    """Marks every process that the test starts."""
    return ProcessMark(monkeypatch)
