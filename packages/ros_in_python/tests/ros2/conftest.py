"""A terminal to type `ros2` in, and a robot of real nodes to look at."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable, Iterator
from contextlib import ExitStack

import pytest
import ros_domains
from ros2_terminal import DEADLINE_S, ROBOT, Robot, Terminal


@pytest.fixture(autouse=True)
def _own_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_IN_PYTHON", "own")


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    """A terminal; everything it started that the test did not stop is killed."""
    it = Terminal(prepared=True)
    yield it
    it.close()


def start(*parts: str) -> subprocess.Popen[str]:
    """Start a process with parts of ros2_robot.py; return when it is ready."""
    process = subprocess.Popen(
        [sys.executable, os.fspath(ROBOT), *parts], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    return process


def end(robots: Iterable[subprocess.Popen[str]]) -> None:
    for process in robots:
        process.kill()
        process.communicate(timeout=DEADLINE_S)


@pytest.fixture
def robot(ros_domain: int) -> Iterator[Robot]:
    """Starts parts of ros2_robot.py as a process: `robot("publisher", "action")`; they are ready when it returns."""
    started: list[subprocess.Popen[str]] = []

    def start_one(*parts: str) -> subprocess.Popen[str]:
        started.append(start(*parts))
        return started[-1]

    yield start_one
    end(started)


@pytest.fixture(scope="module")
def standing_robots() -> Iterator[tuple[dict[tuple[str, ...], tuple[int, subprocess.Popen[str]]], ExitStack]]:
    """Robots that run from test to test, by their parts, each with a domain of its own.

    They end with the file: robots publish without a pause, which slows down everything else on the machine.
    """
    robots: dict[tuple[str, ...], tuple[int, subprocess.Popen[str]]] = {}
    with ExitStack() as domains:
        yield robots, domains
        end(process for _, process in robots.values())


@pytest.fixture
def standing(
    standing_robots: tuple[dict[tuple[str, ...], tuple[int, subprocess.Popen[str]]], ExitStack],
    monkeypatch: pytest.MonkeyPatch,
) -> Robot:
    """As `robot`, for a test that only looks at it: the same process serves all such tests. Call it first of all."""
    robots, domains = standing_robots

    def stand(*parts: str) -> subprocess.Popen[str]:
        domain = robots[parts][0] if parts in robots else domains.enter_context(ros_domains.reserved())
        for name, value in ros_domains.environment(domain).items():
            monkeypatch.setenv(name, value)
        if parts not in robots:
            robots[parts] = (domain, start(*parts))
        return robots[parts][1]

    return stand
