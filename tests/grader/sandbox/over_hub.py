"""Runs programs in a sandbox over the grader's own middleware, with a real hub in the runner's process."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from sandbox_runner import Runner

from grader.sandbox import ForkServer, Isolation, Limits, ProcessExit, ProgramSpec
from rmw_lockstep.hub import Hub

SECOND = 1_000_000_000


@dataclass(frozen=True)
class HubRun:
    """How a program ended, and what it printed."""

    exit: ProcessExit | None
    text: str


class _Over(Exception):
    """Raised out of the hub's waiting when the program has ended, or too much time has passed."""


def run_over_hub(
    runner: Runner, source: str, *, preloaded: bool = True, limits: Limits | None = None, timeout_s: float = 60.0
) -> HubRun:
    """Run a program until its first process ends; its time advances by a second whenever it is idle."""
    program = ProgramSpec("student.py", {"student.py": source.encode()}, ("--ros-args",), preloaded=preloaded)
    run: HubRun = runner.do(in_the_runner, program, limits, timeout_s)
    return run


def in_the_runner(
    fork_server: ForkServer, level: Isolation, program: ProgramSpec, limits: Limits | None, timeout_s: float
) -> HubRun:
    """Do the same, in the runner's process."""
    deadline = time.monotonic() + timeout_s
    with Hub() as hub, fork_server.start(replace(program, hub=hub.add_program()), level, limits) as student:

        def look() -> None:
            if student.poll() is not None or time.monotonic() > deadline:
                raise _Over

        hub.main, hub.on_tick = student.pid, look
        try:
            while True:
                hub.wait_until_idle()
                look()
                hub.advance(hub.now + SECOND)
        except _Over:
            return HubRun(student.poll(), student.output())
