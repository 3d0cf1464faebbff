"""A terminal to type `ros2` in, and a command's answer."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from prepared_python import run_prepared

ROBOT = Path(__file__).parent / "ros2_robot.py"

#: Seconds after which something that should have happened has failed. Generous: the machine may be busy.
DEADLINE_S = 60


@dataclass(frozen=True)
class Answer:
    """The result of a finished command."""

    code: int
    out: str
    err: str


class Running:
    """A command that runs until it is stopped."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.seen = ""

    def lines(self, count: int) -> list[str]:
        """Return the next `count` lines, as they arrive through the pipe."""
        assert self.process.stdout is not None
        got = []
        for _ in range(count):
            line = self.process.stdout.readline()
            assert line, f"ended early: {self.process.communicate()[1]}"
            got.append(line.rstrip("\n"))
        return got

    def stop(self, number: int = signal.SIGINT) -> Answer:
        """Send a signal; return what arrived after the lines that were read."""
        self.process.send_signal(number)
        try:
            out, err = self.process.communicate(timeout=DEADLINE_S)
        except subprocess.TimeoutExpired:
            self.process.send_signal(signal.SIGABRT)  # what its threads do is printed then: see Terminal.start
            raise AssertionError(f"has not ended after {DEADLINE_S} s:\n{self.process.communicate()[1]}") from None
        return Answer(self.process.returncode, out, err)


#: Nouns that ask or tell other nodes something and end. The others start programs, or look at this Python itself.
ASKING = ("action", "interface", "lifecycle", "node", "param", "service", "topic")


class Terminal:
    """Runs `python -m ros_in_python.ros2` in children, as a notebook does."""

    def __init__(self, *, prepared: bool = False) -> None:
        """Have a terminal; `prepared` is whether commands may run in forks of a process that has imported rclpy."""
        self.prepared = prepared
        self.started: list[subprocess.Popen[str]] = []

    def start(self, *arguments: str, cwd: Path | None = None) -> Running:
        process = subprocess.Popen(
            [sys.executable, "-m", "ros_in_python.ros2", *arguments],
            cwd=cwd,
            env={**os.environ, "PYTHONFAULTHANDLER": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.started.append(process)
        return Running(process)

    def ros2(self, *arguments: str, cwd: Path | None = None, stdin: str = "") -> Answer:
        if self.prepared and arguments[:1] and arguments[0] in ASKING:
            done = run_prepared("ros_in_python.ros2", *arguments, cwd=cwd, text=stdin, limit_s=DEADLINE_S)
        else:
            done = subprocess.run(
                [sys.executable, "-m", "ros_in_python.ros2", *arguments],
                cwd=cwd,
                input=stdin,
                capture_output=True,
                text=True,
                timeout=DEADLINE_S,
                check=False,
            )
        assert "Traceback" not in done.stderr, done.stderr
        return Answer(done.returncode, done.stdout, done.stderr)

    def close(self) -> None:
        """Kill everything it started that the test did not stop."""
        for process in self.started:
            if process.poll() is None:
                process.kill()
                process.communicate()


Robot = Callable[..., subprocess.Popen[str]]
