"""Time budgets: the student's CPU time and the time it spends blocked, never wall time."""

from __future__ import annotations

import time
from dataclasses import dataclass

from grader.runner.fastdds.idle import Receivers, Threads
from grader.runner.stopped import Stopped
from grader.runner.student import Student


@dataclass(frozen=True)
class Watch:
    """The student's program with its threads, and the threads by which the rig receives what it sends."""

    student: Student
    threads: Threads
    receivers: Receivers

    def close(self) -> None:
        """Stop looking."""
        self.threads.close()
        self.receivers.close()


#: The longest time between two looks that counts (s): a rig that did not run itself saw nothing. On a machine that
#: is not busy the looks are closer together than this.
LONGEST_LOOK_S = 0.025


class TimeBudget:
    """Ends when the program has used `cpu_s` of CPU time, or was blocked for `blocked_s`, since this was made.

    A program that waits for a CPU on a busy machine uses up neither. A program that has hit a limit of its sandbox is
    about to end, and its exit names the limit: the caller waits for that.
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
        """Return "cpu" or "blocked" when it has ended, otherwise None."""
        self.look()
        if self.blocked >= self._blocked_s:
            return "blocked"
        return "cpu" if self.cpu >= self._cpu_s and not self._student.at_limit() else None

    def check(self, busy: str, blocked: str) -> None:
        """Raise `Stopped` with one of the two messages once the budget has ended."""
        which = self.ended()
        if which:
            raise Stopped("timed-out", busy if which == "cpu" else blocked)


class IdleTime:
    """The time in which neither the program nor the rig has anything to do but wait (s), since this was made.

    A message in transit between the two, on a busy machine, is work for one of them. So what has not arrived after
    sufficient idle time was not sent, or got lost.
    """

    def __init__(self, watch: Watch) -> None:
        self._threads, self._receivers = watch.threads, watch.receivers
        self._looked = time.monotonic()
        self.seconds = 0.0

    def look(self) -> float:
        """Count the time since the last look if all is idle. Return what was counted."""
        now = time.monotonic()
        if not self._threads.at_work() and not self._receivers.at_work():
            self.seconds += min(now - self._looked, LONGEST_LOOK_S)
        self._looked = now
        return self.seconds
