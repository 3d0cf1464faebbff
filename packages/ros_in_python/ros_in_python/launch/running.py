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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from types import FrameType
from typing import IO, Any

from ros_in_python.launch import events
from ros_in_python.launch.actions import LaunchedProgram, LifecycleNode, line_of
from ros_in_python.launch.lifecycle import LifecycleClient
from ros_in_python.launch.plan import LaunchPlan
from ros_in_python.launch.steps import DeferredAction, Emission, EventStep, HandlerRemoval, Later, ProcessToStart, Step
from ros_in_python.ros2.cli import CommandError

#: How often to check whether a process has ended without closing its output (s).
_POLL_S = 0.1


@dataclass
class _LaunchedProcess:
    """`due` are the signals that it gets if it has not ended by then; `is_told` says that it was asked to end."""

    name: str
    step: ProcessToStart
    process: subprocess.Popen[bytes]
    readers: list[threading.Thread] = field(default_factory=list)
    due: list[tuple[float, signal.Signals]] = field(default_factory=list)
    is_told: bool = False

    @property
    def what(self) -> tuple[LaunchedProgram, str, int]:
        """What an event tells of it: its action, its name and its process's number."""
        return (self.step.action, self.name, self.process.pid)

    def send(self, number: int) -> None:
        """Send a signal to it and to all that it has started."""
        self.is_told = True
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.process.pid, number)

    def end(self, number: signal.Signals) -> None:
        """Ask it to end, the first time with stronger signals to follow."""
        to_term, to_kill = self.step.grace_s
        now = time.monotonic()
        self.due = self.due or [(now + to_term, signal.SIGTERM), (now + to_term + to_kill, signal.SIGKILL)]
        self.send(number)


class ProcessGroup:
    """The running processes of one launch. Its plan gives the steps that a handler takes about an event."""

    def __init__(self, plan: LaunchPlan) -> None:
        self._plan = plan
        self._queue: queue.Queue[Any] = queue.Queue()
        self._running: list[_LaunchedProcess] = []
        self._handlers: list[EventStep] = []
        self._later: list[tuple[float, int, Later]] = []
        self._numbers, self._order = itertools.count(1), itertools.count()
        self._is_ending = self._died = self._was_interrupted = False
        self._print_lock = threading.Lock()
        self._lifecycle: LifecycleClient | None = None

    def run(self, steps: Sequence[Step]) -> int:
        """Do all steps and wait until all has ended. Return 1 if a program died by itself, 0 if not and after Ctrl-C.

        Raises `CommandError` if a program can't be started, or a handler of the launch file fails.
        """
        with self._listening():
            try:
                self._do(steps)
                self._wait_for_all()
                self._end(signal.SIGINT, events.ShutdownRequested("idle"))
                self._wait_for_all()  # what handlers of the end have begun
            finally:
                self._kill()
                if self._lifecycle:
                    self._lifecycle.close()
        return int(self._died and not self._was_interrupted)

    # --- steps

    def _do(self, steps: Sequence[Step]) -> None:
        # As in ROS 2, a handler also hears of a program that stands before it in the launch file.
        self._handlers += [step for step in steps if isinstance(step, EventStep)]
        for step in steps:
            if isinstance(step, str):
                self._say("INFO", "launch.user", step)
            elif isinstance(step, Later):
                self._schedule(step)
            elif isinstance(step, DeferredAction):
                self._do(self._plan.due([step]))
            elif isinstance(step, HandlerRemoval):
                self._handlers = [other for other in self._handlers if other.handler is not step.handler]
            elif isinstance(step, Emission):
                self._emit(step.event)
            elif isinstance(step, ProcessToStart) and not self._is_ending:
                self._start(step)

    def _schedule(self, later: Later) -> None:
        if not (self._is_ending and later.is_cancelled_at_end):
            heapq.heappush(self._later, (time.monotonic() + later.seconds, next(self._order), later))

    def _emit(self, event: Any) -> None:
        if isinstance(event, events.ShutdownRequested):
            self._end(signal.SIGINT, event)
            return
        for running in list(self._running):
            action = running.step.action
            if isinstance(event, events.ShutdownProcess) and event.process_matcher(action):
                self._announce(running, signal.SIGINT)
                running.end(signal.SIGINT)
            elif isinstance(event, events.SignalProcess) and event.process_matcher(action):
                self._announce(running, event.number)
                running.send(event.number)
            elif (
                isinstance(event, events.ChangeState)
                and isinstance(action, LifecycleNode)
                and event.lifecycle_node_matcher(action)
            ):
                self._life().change(action, event.transition_id)
        self._happened(event)

    def _life(self) -> LifecycleClient:
        self._lifecycle = self._lifecycle or LifecycleClient(self._queue.put)
        return self._lifecycle

    def _announce(self, running: _LaunchedProcess, number: signal.Signals) -> None:
        self._say("INFO", running.name, f"sending signal '{number.name}' to process[{running.name}]")

    def _start(self, step: ProcessToStart) -> None:
        hears_lines = any(isinstance(other.handler, events.OnProcessIO) for other in self._handlers)
        name = step.name_again or f"{step.name}-{next(self._numbers)}"
        if isinstance(step.action, LifecycleNode):
            self._life().watch(step.action)
        if step.action.log_cmd:
            self._say("INFO", name, f"process details: cmd='{' '.join(step.argv)}', cwd='{step.cwd}'")
        try:
            process = subprocess.Popen(
                step.argv,
                env=step.env,
                cwd=step.cwd,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                # One pipe keeps the lines in order; only handlers need to know which output a line came from.
                stderr=subprocess.PIPE if hears_lines else subprocess.STDOUT,
                # A terminal's Ctrl-C is handed on by this process, once.
                start_new_session=True,
            )
        except OSError as error:
            raise CommandError(f"{step.argv[0]} could not be started: {error.strerror}") from None
        step.action.process_details = {"name": name, "pid": process.pid, "cmd": step.argv}
        running = _LaunchedProcess(name, step, process)
        self._running.append(running)
        self._say("INFO", name, f"process started with pid [{process.pid}]")
        for output in (process.stdout, process.stderr):
            if output is not None:
                running.readers.append(threading.Thread(target=self._read, args=(running, output), daemon=True))
                running.readers[-1].start()
        self._happened(events.ProcessStarted(*running.what))

    def _happened(self, event: Any) -> None:
        for step in list(self._handlers):
            steps = self._plan.reaction(step, event)
            if steps is None:
                continue
            if step.handler.handle_once:
                self._handlers.remove(step)
            if isinstance(event, events.ProcessExited) and not self._is_ending and any(map(_ends, steps)):
                self._say(
                    "INFO", "launch", f"process[{event.process_name}] was required: shutting down launched system"
                )
            self._do(steps)

    # --- what the processes do

    def _read(self, running: _LaunchedProcess, output: IO[bytes]) -> None:
        is_stdout = output is running.process.stdout
        for line in output:
            self._print(line_of(running.step.action, running.name, line.decode(errors="replace").rstrip()))
            if any(isinstance(step.handler, events.OnProcessIO) for step in self._handlers):
                self._queue.put(events.ProcessIO(*running.what, line, is_stdout))
        if is_stdout:
            self._queue.put(running)

    def _wait_for_all(self) -> None:
        while self._running or self._later:
            self._wait()

    def _wait(self) -> None:
        with contextlib.suppress(queue.Empty):
            self._take(self._queue.get(timeout=self._until_next()))
        for running in [item for item in self._running if item.process.poll() is not None]:
            for reader in running.readers:
                reader.join(timeout=1.0)
            while not self._queue.empty():  # its last lines come before its end
                self._take(self._queue.get_nowait())
            self._running.remove(running)
            self._ended(running)
        now = time.monotonic()
        while self._later and self._later[0][0] <= now:
            self._do(heapq.heappop(self._later)[2].steps)
        for running in self._running:
            while running.due and running.due[0][0] <= now:
                self._escalate(running)

    def _escalate(self, running: _LaunchedProcess) -> None:
        (_, stronger), seconds = running.due.pop(0), running.step.grace_s
        is_first = stronger == signal.SIGTERM
        after, weaker = (seconds[0], "SIGINT") if is_first else (sum(seconds), "SIGTERM")
        self._say(
            "ERROR",
            running.name,
            f"process[{running.name}] failed to terminate '{after}' seconds after receiving '{weaker}', "
            f"escalating to '{stronger.name}'",
        )
        self._announce(running, stronger)
        running.send(stronger)

    def _take(self, event: Any) -> None:
        if isinstance(event, int):
            self._interrupted(event)
        elif isinstance(event, str):
            self._say("ERROR", "launch_ros", event)
        elif isinstance(event, _LaunchedProcess):
            event.process.wait()
        else:
            self._happened(event)

    def _until_next(self) -> float:
        due = self._later[0][0] - time.monotonic() if self._later else _POLL_S
        return max(0.0, min(_POLL_S, due))

    def _interrupted(self, number: int) -> None:
        if number == signal.SIGINT:
            again = " again" if self._was_interrupted else ""
            self._say("WARNING", "launch", f"user interrupted with ctrl-c (SIGINT){again}")
        self._was_interrupted = True
        self._end(signal.Signals(number), events.ShutdownRequested("ctrl-c (SIGINT)", due_to_sigint=True))

    def _end(self, number: signal.Signals, event: events.ShutdownRequested) -> None:
        """Send all programs a signal; the first time, tell the handlers."""
        first, self._is_ending = not self._is_ending, True
        self._later = [entry for entry in self._later if not entry[2].is_cancelled_at_end]
        heapq.heapify(self._later)
        for running in self._running:
            if not event.due_to_sigint:
                self._announce(running, number)
            running.end(number)
        if first:
            self._happened(event)

    def _ended(self, running: _LaunchedProcess) -> None:
        code, pid, step = running.process.returncode, running.process.pid, running.step
        if code == 0:
            self._say("INFO", running.name, f"process has finished cleanly [pid {pid}]")
        else:
            self._died = self._died or not running.is_told
            words = step.argv[2:] if getattr(step.action, "shell", False) else step.argv  # without /bin/sh -c
            cmd = " ".join(word for word in words if word.strip())
            self._say("ERROR", running.name, f"process has died [pid {pid}, exit code {code}, cmd '{cmd}'].")
        self._happened(events.ProcessExited(*running.what, code))
        if step.respawn_s is not None and step.respawns > 0 and not self._is_ending:
            again = replace(step, respawns=step.respawns - 1, name_again=running.name)
            self._schedule(Later(step.respawn_s, (again,)))
        else:
            self._happened(events.ExecutionComplete(step.action))

    def _kill(self) -> None:
        for running in self._running:
            running.send(signal.SIGKILL)
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


def _ends(step: Step) -> bool:
    return isinstance(step, Emission) and isinstance(step.event, events.ShutdownRequested)
