"""Runs the programs of a launch: every line that one prints begins with its name, and a signal reaches them all."""

from __future__ import annotations

import contextlib
import heapq
import itertools
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from types import FrameType
from typing import Any

from ros_in_python.launch import events
from ros_in_python.launch.plan import EndOfLaunch, EventStep, Later, ProcessToStart, Step
from ros_in_python.ros2.cli import CommandError

#: How long programs may take to end after SIGINT, and then after SIGTERM, before they are killed (s): as in ROS 2.
GRACE = (5.0, 5.0)
#: How often to check whether a process has ended without closing its output (s).
_POLL_S = 0.1


@dataclass
class _Running:
    name: str
    step: ProcessToStart
    process: subprocess.Popen[bytes]
    reader: threading.Thread

    @property
    def what(self) -> tuple[Any, str, int]:
        """What an event tells of it: its action, its name and its process's number."""
        return (self.step.action, self.name, self.process.pid)


class ProcessGroup:
    """The running processes of one launch. `reaction` gives the steps that a handler takes about an event."""

    def __init__(self, reaction: Callable[[EventStep, Any], Sequence[Step]]) -> None:
        self._reaction = reaction
        self._queue: queue.Queue[_Running | int | events.ProcessIO] = queue.Queue()
        self._running: list[_Running] = []
        self._handlers: list[EventStep] = []
        self._later: list[tuple[float, int, tuple[Step, ...]]] = []
        self._numbers, self._order = itertools.count(1), itertools.count()
        self._deadline: float | None = None
        self._next_signal = signal.SIGTERM
        self._died = self._was_interrupted = False
        self._print_lock = threading.Lock()

    def run(self, steps: Sequence[Step]) -> int:
        """Do all steps and wait until all has ended. Return 1 if a program died by itself, 0 if not and after Ctrl-C.

        Raises `CommandError` if a program can't be started, or a handler of the launch file fails.
        """
        with self._listening():
            try:
                self._do(steps)
                while self._running or (self._later and not self._is_ending):
                    self._wait()
            finally:
                self._kill()
        return int(self._died and not self._was_interrupted)

    @property
    def _is_ending(self) -> bool:
        return self._deadline is not None

    # --- steps

    def _do(self, steps: Sequence[Step]) -> None:
        # As in ROS 2, a handler also hears of a program that stands before it in the launch file.
        self._handlers += [step for step in steps if isinstance(step, EventStep)]
        for step in steps:
            if isinstance(step, str):
                self._say("INFO", "launch.user", step)
            elif isinstance(step, EndOfLaunch):
                self._end(signal.SIGINT, events.ShutdownRequested(step.reason))
            elif isinstance(step, Later):
                self._schedule(step.seconds, step.steps)
            elif isinstance(step, ProcessToStart) and not self._is_ending:
                self._start(step)

    def _schedule(self, seconds: float, steps: tuple[Step, ...]) -> None:
        heapq.heappush(self._later, (time.monotonic() + seconds, next(self._order), steps))

    def _start(self, step: ProcessToStart) -> None:
        try:
            process = subprocess.Popen(
                step.argv,
                env=step.env,
                cwd=step.cwd,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                # A terminal's Ctrl-C is handed on by this process, once.
                start_new_session=True,
            )
        except OSError as error:
            raise CommandError(f"{step.argv[0]} could not be started: {error.strerror}") from None
        name = f"{step.name}-{next(self._numbers)}"
        running = _Running(name, step, process, threading.Thread(target=lambda: self._read(running), daemon=True))
        self._running.append(running)
        self._say("INFO", name, f"process started with pid [{process.pid}]")
        running.reader.start()
        self._happened(events.ProcessStarted(*running.what))

    def _happened(self, event: Any) -> None:
        for handler in [step for step in self._handlers if events.concerns(step.handler, event)]:
            self._do(self._reaction(handler, event))

    # --- what the processes do

    def _read(self, running: _Running) -> None:
        assert running.process.stdout is not None
        for line in running.process.stdout:
            self._print(f"[{running.name}] {line.decode(errors='replace').rstrip()}")
            if any(isinstance(step.handler, events.OnProcessIO) for step in self._handlers):
                self._queue.put(events.ProcessIO(*running.what, line))
        self._queue.put(running)

    def _wait(self) -> None:
        with contextlib.suppress(queue.Empty):
            self._take(self._queue.get(timeout=self._until_next()))
        for running in [item for item in self._running if item.process.poll() is not None]:
            running.reader.join(timeout=1.0)
            while not self._queue.empty():  # its last lines come before its end
                self._take(self._queue.get_nowait())
            self._running.remove(running)
            self._ended(running)
        while self._later and self._later[0][0] <= time.monotonic() and not self._is_ending:
            self._do(heapq.heappop(self._later)[2])
        if self._deadline is not None and time.monotonic() >= self._deadline:
            self._signal(self._next_signal)
            self._deadline = time.monotonic() + GRACE[1]
            self._next_signal = signal.SIGKILL

    def _take(self, event: _Running | int | events.ProcessIO) -> None:
        if isinstance(event, int):
            self._interrupted(event)
        elif isinstance(event, events.ProcessIO):
            self._happened(event)
        else:
            event.process.wait()

    def _until_next(self) -> float:
        due = self._later[0][0] - time.monotonic() if self._later else _POLL_S
        return max(0.0, min(_POLL_S, due))

    def _interrupted(self, number: int) -> None:
        if not self._is_ending and number == signal.SIGINT:
            self._say("WARNING", "launch", "user interrupted with ctrl-c (SIGINT)")
        self._was_interrupted = True
        self._end(signal.Signals(number), events.ShutdownRequested("ctrl-c (SIGINT)", due_to_sigint=True))

    def _end(self, number: signal.Signals, event: events.ShutdownRequested) -> None:
        """Send all programs a signal; the first time, tell the handlers."""
        first = not self._is_ending
        self._deadline = time.monotonic() + GRACE[0] if self._deadline is None else self._deadline
        self._signal(number)
        if first:
            self._happened(event)

    def _ended(self, running: _Running) -> None:
        code, pid = running.process.returncode, running.process.pid
        if code == 0:
            self._say("INFO", running.name, f"process has finished cleanly [pid {pid}]")
        else:
            self._died = self._died or not self._is_ending
            self._say("ERROR", running.name, f"process has died [pid {pid}, exit code {code}]")
        self._happened(events.ProcessExited(*running.what, code))
        if running.step.respawn_s is not None and not self._is_ending:
            self._schedule(running.step.respawn_s, (running.step,))

    def _signal(self, number: signal.Signals) -> None:
        for running in self._running:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(running.process.pid, number)

    def _kill(self) -> None:
        self._signal(signal.SIGKILL)
        for running in self._running:
            running.process.wait()

    # --- what is printed, and signals

    def _say(self, level: str, name: str, text: str) -> None:
        self._print(f"[{level}] [{name}]: {text}")

    def _print(self, line: str) -> None:
        with self._print_lock, contextlib.suppress(BrokenPipeError):
            print(line, file=sys.stdout, flush=True)

    @contextlib.contextmanager
    def _listening(self) -> Iterator[None]:
        def on_signal(number: int, frame: FrameType | None) -> None:
            self._queue.put(number)

        before = {number: signal.signal(number, on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
