"""Runs the processes of a launch: every line that one prints begins with its name, and a signal reaches them all."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import FrameType

from ros_in_python.launch.processes import ProcessToStart
from ros_in_python.ros2.cli import CommandError

#: How long nodes may take to end after SIGINT, and then after SIGTERM, before they are killed (s): as in ROS 2.
GRACE = (5.0, 5.0)
#: How often to check whether a process has ended without closing its output (s).
_POLL_S = 0.1


@dataclass
class _Running:
    name: str
    process: subprocess.Popen[bytes]
    reader: threading.Thread


class ProcessGroup:
    """The running processes of one launch."""

    def __init__(self) -> None:
        self._events: queue.Queue[_Running | int] = queue.Queue()
        self._running: list[_Running] = []
        self._deadline: float | None = None
        self._next_signal = signal.SIGTERM
        self._died = False
        self._print_lock = threading.Lock()

    def run(self, steps: Sequence[ProcessToStart | str]) -> int:
        """Start all and wait until all have ended. Return 1 if one died by itself, 0 otherwise and after Ctrl-C."""
        with self._listening():
            try:
                for step in _numbered(steps):
                    self._step(step)
                while self._running:
                    self._wait()
            finally:
                self._kill()
        return int(self._died and self._deadline is None)

    def _step(self, step: ProcessToStart | str) -> None:
        if isinstance(step, str):
            self._say("INFO", "launch.user", step)
            return
        try:
            process = subprocess.Popen(
                step.argv,
                env=step.env,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                # A terminal's Ctrl-C is handed on by this process, once.
                start_new_session=True,
            )
        except OSError as error:
            raise CommandError(f"{step.argv[0]} could not be started: {error.strerror}") from None
        running = _Running(step.name, process, threading.Thread(target=lambda: self._read(running), daemon=True))
        self._running.append(running)
        self._say("INFO", step.name, f"process started with pid [{process.pid}]")
        running.reader.start()

    def _read(self, running: _Running) -> None:
        assert running.process.stdout is not None
        for line in running.process.stdout:
            self._print(f"[{running.name}] {line.decode(errors='replace').rstrip()}")
        self._events.put(running)

    def _wait(self) -> None:
        with contextlib.suppress(queue.Empty):
            event = self._events.get(timeout=_POLL_S)
            if isinstance(event, int):
                self._interrupted(event)
            else:
                event.process.wait()
        for running in [item for item in self._running if item.process.poll() is not None]:
            running.reader.join(timeout=1.0)
            self._running.remove(running)
            self._ended(running)
        if self._deadline is not None and time.monotonic() >= self._deadline:
            self._signal(self._next_signal)
            self._deadline = time.monotonic() + GRACE[1]
            self._next_signal = signal.SIGKILL

    def _interrupted(self, number: int) -> None:
        if self._deadline is None and number == signal.SIGINT:
            self._say("WARNING", "launch", "user interrupted with ctrl-c (SIGINT)")
        self._deadline = time.monotonic() + GRACE[0] if self._deadline is None else self._deadline
        self._signal(signal.Signals(number))

    def _ended(self, running: _Running) -> None:
        code, pid = running.process.returncode, running.process.pid
        if code == 0:
            self._say("INFO", running.name, f"process has finished cleanly [pid {pid}]")
            return
        self._died = True
        self._say("ERROR", running.name, f"process has died [pid {pid}, exit code {code}]")

    def _signal(self, number: signal.Signals) -> None:
        for running in self._running:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(running.process.pid, number)

    def _kill(self) -> None:
        self._signal(signal.SIGKILL)
        for running in self._running:
            running.process.wait()

    def _say(self, level: str, name: str, text: str) -> None:
        self._print(f"[{level}] [{name}]: {text}")

    def _print(self, line: str) -> None:
        with self._print_lock, contextlib.suppress(BrokenPipeError):
            print(line, file=sys.stdout, flush=True)

    @contextlib.contextmanager
    def _listening(self) -> Iterator[None]:
        def on_signal(number: int, frame: FrameType | None) -> None:
            self._events.put(number)

        before = {number: signal.signal(number, on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def _numbered(steps: Sequence[ProcessToStart | str]) -> Iterator[ProcessToStart | str]:
    """Yield the steps, with the processes numbered in the order in which they start."""
    count = 0
    for step in steps:
        if isinstance(step, str):
            yield step
        else:
            count += 1
            yield ProcessToStart(f"{step.name}-{count}", step.argv, step.env)
