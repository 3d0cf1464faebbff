"""Time budgets: the student's CPU time and the time it spends blocked, never wall time."""

from __future__ import annotations

import time
from dataclasses import dataclass

from grader.runner.fastdds.idle import Receivers, Threads
from grader.runner.stopped import Stopped
from grader.runner.student import Student


@dataclass(frozen=True)
class Watch:
    """The student's program with its threads, and the threads by which the rig hears of what it does."""

    student: Student
    threads: Threads
    receivers: Receivers

    def close(self) -> None:
        """Look no more."""
        self.threads.close()
        self.receivers.close()


#: The longest piece of time between two looks that counts: a rig that did not run itself saw nothing. Where a machine
#: is not busy the looks come sooner than this.
LONGEST_LOOK_S = 0.025


class TimeBudget:
    """Ends when the program has used `cpu_s` of CPU time, or was blocked for `blocked_s`, since this was made.

    A program that waits for a CPU on a busy machine uses up neither. One that has run into a limit of its sandbox is
    about to end, and its end tells which limit it was: that is waited for.
    """

    def __init__(self, watch: Watch, cpu_s: float = 3.0, blocked_s: float = 3.0) -> None:
        self._student, self._threads = watch.student, watch.threads
        self._cpu_s, self._blocked_s = cpu_s, blocked_s
        self._cpu_start = watch.student.cpu_seconds()
        self._looked = time.monotonic()
        self.blocked = 0.0

    @property
    def cpu(self) -> float:
        """Seconds of CPU time used so far."""
        return self._student.cpu_seconds() - self._cpu_start

    def look(self) -> None:
        """Count the time since the last look as blocked if none of the program's threads could run."""
        now = time.monotonic()
        if not self._threads.at_work():
            self.blocked += min(now - self._looked, LONGEST_LOOK_S)
        self._looked = now

    def ended(self) -> str | None:
        """ "cpu" or "blocked" when it has ended, else None."""
        self.look()
        if self.blocked >= self._blocked_s:
            return "blocked"
        return "cpu" if self.cpu >= self._cpu_s and not self._student.at_limit() else None

    def check(self, busy: str, blocked: str) -> None:
        """Raise `Stopped` with one of the two stories once the budget has ended."""
        which = self.ended()
        if which:
            raise Stopped("timed-out", busy if which == "cpu" else blocked)


class IdleTime:
    """The time in which neither the program nor the rig has anything to do but wait (s), since this was made.

    What is on its way between the two, on a busy machine, is work for one of them. So what has not come after
    sufficient idle time was not sent, or got lost.
    """

    def __init__(self, watch: Watch) -> None:
        self._threads, self._receivers = watch.threads, watch.receivers
        self._looked = time.monotonic()
        self.seconds = 0.0

    def look(self) -> float:
        """Count the time since the last look if all is idle. Returns what has been counted."""
        now = time.monotonic()
        if not self._threads.at_work() and not self._receivers.at_work():
            self.seconds += min(now - self._looked, LONGEST_LOOK_S)
        self._looked = now
        return self.seconds
