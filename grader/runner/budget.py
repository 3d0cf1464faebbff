"""Limits how long a program may take: by its own CPU time and the time it is blocked, never by wall time."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

from grader.runner.program import CannotContinue, RunningProgram

#: The longest time between two looks that counts (s): longer gaps mean that the grader itself did not run.
LONGEST_LOOK_S = 0.025

#: The limit for one step of a run, far above what any correct program needs.
CPU_S, BLOCKED_S = 3.0, 3.0


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
        self.begin(allowance)

    def begin(self, allowance: Allowance) -> None:
        """Begin a new step."""
        self._allowance = allowance
        self._cpu_start: float | None = None
        self._ran: int | None = None
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

        The first call reads nothing, as most steps end before the second.

        Raises:
            ProgramExited: if the program has ended.
            CannotContinue: if the step exceeds its allowance.
        """
        now = time.monotonic()
        passed = min(now - self._looked, LONGEST_LOOK_S)
        self._looked = now
        self._seen += passed
        if self._student.poll() is not None:
            raise ProgramExited
        if self._cpu_start is None:
            self._cpu_start = self._student.cpu_seconds()
            return
        before, self._ran = self._ran, ran(self._pids())
        if self._ran is not None and self._ran == before:
            self.blocked += passed
        self._check()

    def _check(self) -> None:
        allowance = self._allowance
        if self.blocked >= allowance.blocked_s:
            raise CannotContinue("timed-out", allowance.blocked)
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


def ran(pids: Collection[int]) -> int | None:
    """Return how long the processes' threads have run (ns); None if one is running, ready or waiting for the disk."""
    total = 0
    for thread in (thread for pid in pids for thread in _threads(pid)):
        with contextlib.suppress(OSError):  # it has just ended
            # The state follows the program's name, which may contain any character but ends with the last bracket.
            name, _, rest = (thread / "stat").read_bytes().rpartition(b") ")
            if name.endswith(SUPERVISOR):
                continue
            if rest[:1] in (b"R", b"D"):
                return None
            total += int((thread / "schedstat").read_bytes().split()[0])
    return total


def _threads(pid: int) -> list[Path]:
    folder = Path(f"/proc/{pid}/task")
    with contextlib.suppress(OSError):
        return [folder / name for name in os.listdir(folder)]  # noqa: PTH208 - names alone
    return []
