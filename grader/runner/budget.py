"""How long a program is waited for: in its own CPU time, and in time that it spends blocked, never in wall time."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

from grader.runner.stopped import Stopped
from grader.runner.student import Student

#: The longest piece of time between two looks that counts: a grader that did not run itself saw nothing.
LONGEST_LOOK_S = 0.025

#: What one step of a run may take, which no right program comes near.
CPU_S, BLOCKED_S = 3.0, 3.0


class Gone(Exception):
    """Raised when the student's program has ended by itself."""


class HostStalled(Exception):
    """Raised when the machine, and not the program, was what did not go on."""


@dataclass(frozen=True)
class Allowance:
    """What one step may take, in seconds of CPU time and of time blocked, and what is said when it takes more."""

    busy: str
    blocked: str
    cpu_s: float = CPU_S
    blocked_s: float = BLOCKED_S


class Budget:
    """Looks at the student's program from time to time while it is waited for: see `look`."""

    def __init__(self, student: Student, pids: Callable[[], Collection[int]], allowance: Allowance) -> None:
        """`pids` tells the numbers of the program's processes."""
        self._student, self._pids = student, pids
        self._began = self._looked = time.monotonic()
        self._seen = 0.0
        self.begin(allowance)

    def begin(self, allowance: Allowance) -> None:
        """A new step begins."""
        self._allowance = allowance
        self._cpu_start: float | None = None
        self._ran: int | None = None
        self.blocked = 0.0

    @property
    def used(self) -> float:
        """Seconds of this step that the program has computed or was blocked for, as far as anybody has looked."""
        return self.blocked + self._cpu

    @property
    def _cpu(self) -> float:
        return 0.0 if self._cpu_start is None else self._student.cpu_seconds() - self._cpu_start

    def look(self) -> None:
        """To be called every 20 ms. Raises `Gone`, or `Stopped` when the step takes more than it may.

        Most steps are over before this is called twice within one: only then is anything read.
        """
        now = time.monotonic()
        passed = min(now - self._looked, LONGEST_LOOK_S)
        self._looked = now
        self._seen += passed
        if self._student.poll() is not None:
            raise Gone
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
            raise Stopped("timed-out", allowance.blocked)
        # One that has run into a limit of its sandbox is about to end, and its end tells which limit it was.
        if self._cpu >= allowance.cpu_s and not self._student.at_limit():
            raise Stopped("timed-out", allowance.busy)

    def check_the_host(self) -> None:
        """Raise `HostStalled` when this machine ran too little for a limit in wall time to say anything."""
        real = time.monotonic() - self._began
        if self._seen < real / 2:
            raise HostStalled(f"this machine was frozen or overloaded: it ran for {self._seen:.0f} s of {real:.0f} s")


#: What liblockstep calls its own thread, which looks at the others again and again while the process is not idle.
SUPERVISOR = b"(lockstep"


def ran(pids: Collection[int]) -> int | None:
    """For how long the threads of these processes have run (ns); None while one runs, could, or waits for the disk."""
    total = 0
    for thread in (thread for pid in pids for thread in _threads(pid)):
        with contextlib.suppress(OSError):  # it has just ended
            # The state follows the program's name, which may hold any character but ends with the last bracket.
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
