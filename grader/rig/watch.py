"""What a rig looks at while it waits."""

from __future__ import annotations

from dataclasses import dataclass

from grader.rig.quiet import Receivers, Threads
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
