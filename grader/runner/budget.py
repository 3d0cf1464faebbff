"""Limits how long a program may take: by its own CPU time and the time it is blocked, never by wall time."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from grader.runner.program import CannotContinue, RunningProgram

#: The longest time between two looks that counts (s), a little more than between two of the hub's ticks. After a longer
#: one the grader itself did not run, and the program may have waited for the grader.
LONGEST_LOOK_S = 0.025

#: The limit for one step of a run, far above what any correct program needs.
CPU_S, BLOCKED_S = 3.0, 3.0

#: How long a program may be blocked in all steps of a run together (s).
BLOCKED_IN_ALL_S = 10.0

BLOCKED_IN_ALL = (
    f"Your program did not go on for {BLOCKED_IN_ALL_S:g} s in all: again and again, it waits for something outside it."
)


class ProgramExited(Exception):
    """Raised if the student's program has ended by itself."""


class HostStalled(Exception):
    """Raised if the machine, and not the program, made no progress."""


@dataclass(frozen=True)
class Allowance:
    """The CPU time and blocked time that one step may take (s), and the messages for taking more."""

    busy: str
    blocked: str
    cpu_s: float = CPU_S
    blocked_s: float = BLOCKED_S


class Budget:
    """Checks the student's program from time to time while the runner waits for it: see `look`."""

    def __init__(self, student: RunningProgram, pids: Callable[[], Collection[int]], allowance: Allowance) -> None:
        """`pids` returns the ids of the program's processes."""
        self._student, self._pids = student, pids
        self._began = self._looked = time.monotonic()
        self._seen = 0.0
        self.blocked = self._blocked_before = 0.0
        self.begin(allowance)

    def begin(self, allowance: Allowance) -> None:
        """Begin a new step."""
        self._allowance = allowance
        self._cpu_start: float | None = None
        self._times: ThreadTimes | None = None
        self._blocked_before += self.blocked
        self.blocked = 0.0

    @property
    def used(self) -> float:
        """The seconds that the program computed or was blocked in this step, up to the last look."""
        return self.blocked + self._cpu

    @property
    def _cpu(self) -> float:
        return 0.0 if self._cpu_start is None else self._student.cpu_seconds() - self._cpu_start

    def look(self) -> None:
        """Count the time since the last look. Call this every 20 ms.

        The first call reads nothing, as most steps end before the second. Raises `ProgramExited` if the program has
        ended, and `CannotContinue` if the step exceeds its allowance.
        """
        now = time.monotonic()
        passed = now - self._looked if now - self._looked <= LONGEST_LOOK_S else 0.0
        self._looked = now
        self._seen += passed
        if self._student.poll() is not None:
            raise ProgramExited
        if self._cpu_start is None:
            self._cpu_start = self._student.cpu_seconds()
            return
        before, self._times = self._times, thread_times(self._student.pid, self._pids())
        if before and self._times.is_blocked_since(before):
            self.blocked += passed
        self._check()

    def _check(self) -> None:
        allowance = self._allowance
        if self.blocked >= allowance.blocked_s:
            raise CannotContinue("timed-out", allowance.blocked)
        if self._blocked_before + self.blocked >= BLOCKED_IN_ALL_S:
            raise CannotContinue("timed-out", BLOCKED_IN_ALL)
        # A program that has hit a limit of its sandbox is about to end, and its exit names the limit.
        if self._cpu >= allowance.cpu_s and not self._student.at_limit():
            raise CannotContinue("timed-out", allowance.busy)

    def check_the_host(self) -> None:
        """Raise `HostStalled` if this machine ran too little for a wall-time limit to mean anything."""
        real = time.monotonic() - self._began
        if self._seen < real / 2:
            raise HostStalled(f"this machine was frozen or overloaded: it ran for {self._seen:.0f} s of {real:.0f} s")


#: The name of liblockstep's own thread, which checks the other threads repeatedly while the process is not idle.
SUPERVISOR = b"(lockstep"

#: The flag of a thread that is ending (PF_EXITING of Linux's sched.h). The last thread of a program gives its memory
#: back, for which it may wait in the kernel for every other program that has mapped the same libraries.
EXITING = 0x4


@dataclass(frozen=True)
class ThreadTimes:
    """How long each of a program's threads has run (ns), by its folder in /proc.

    `ready` is whether anything that it needs waits for a CPU, or inside the kernel for the disk or a lock: one of its
    threads, or who has to report that its first process has ended. `supervisors` are the threads of liblockstep that
    wait for a CPU. They have to hand over time and messages, but also look again and again whether anything happens.
    """

    threads: Mapping[Path, int]
    supervisors: Mapping[Path, int]
    ready: bool

    def is_blocked_since(self, before: ThreadTimes) -> bool:
        """Return whether nothing could run since `before`, and each thread of liblockstep that waits had its turn."""
        had_turns = all(before.supervisors.get(thread, ran) != ran for thread, ran in self.supervisors.items())
        return had_turns and not (self.ready or before.ready) and self.threads == before.threads


def thread_times(first: int, pids: Collection[int]) -> ThreadTimes:
    """Read the times of the threads of processes. `first` is the one whose end the sandbox reports, 0 for none."""
    threads: dict[Path, int] = {}
    supervisors: dict[Path, int] = {}
    ready, alive = False, not first
    for pid in pids:
        for thread in _threads(pid):
            with contextlib.suppress(OSError):  # it has just ended
                # The state follows the program's name, which may contain any character but ends with the last bracket.
                name, _, rest = (thread / "stat").read_bytes().rpartition(b") ")
                ran = int((thread / "schedstat").read_bytes().split()[0])
                state, *numbers = rest.split()
                alive |= pid == first and state not in (b"Z", b"X")
                looks_again = name.endswith(SUPERVISOR) and not int(numbers[5]) & EXITING
                ready |= state == b"D" or (state == b"R" and not looks_again)
                if not looks_again:
                    threads[thread] = ran
                elif state == b"R":
                    supervisors[thread] = ran
    return ThreadTimes(threads, supervisors, ready or not alive)


def _threads(pid: int) -> list[Path]:
    folder = Path(f"/proc/{pid}/task")
    with contextlib.suppress(OSError):
        return [folder / name for name in os.listdir(folder)]  # noqa: PTH208 - names alone
    return []
