"""A terminal to type `ros2` in, and a robot of real nodes to look at."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator

import pytest
from ros2_terminal import PATIENCE, ROBOT, Robot, Terminal


@pytest.fixture(autouse=True)
def _own_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPINBOOK_ROS2", "own")


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    """Whatever it started and the test did not stop is killed."""
    it = Terminal()
    yield it
    for process in it.started:
        if process.poll() is None:
            process.kill()
            process.communicate()


@pytest.fixture
def robot(ros_domain: int) -> Iterator[Robot]:
    """Start parts of robot.py as a process: `robot("publisher", "action")`; they are ready when it returns."""
    started: list[subprocess.Popen[str]] = []

    def start(*parts: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, os.fspath(ROBOT), *parts], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        started.append(process)
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate(timeout=PATIENCE)
