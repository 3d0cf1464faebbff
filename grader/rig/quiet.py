"""Whether anything at all happens inside a program, from what the kernel keeps about its threads."""

from __future__ import annotations

import os
import time
from pathlib import Path

from grader.rig.student import Student

#: Thread -> what its schedstat says: ns on a CPU, ns waiting for one, times it got one.
Activity = dict[str, bytes]

#: How the middleware names its threads, and those of them that listen to a socket.
MIDDLEWARE, RECEIVER = b"dds.", "dds.udp"

#: How long to wait between two looks for the end of something that takes less than a millisecond.
LOOK_S = 0.0001


class Receivers:
    """The threads of this process that take in what the middleware gets: all that there are when this is made."""

    def __init__(self) -> None:
        self._states = [
            os.open(f"/proc/self/task/{thread}/stat", os.O_RDONLY | os.O_CLOEXEC)
            for thread in os.listdir("/proc/self/task")  # noqa: PTH208
            if Path(f"/proc/self/task/{thread}/comm").read_text().startswith(RECEIVER)
        ]
        assert self._states, "the middleware has no thread of its own"

    def at_work(self) -> bool:
        """Whether one of them runs, or waits for a CPU to run on."""
        return any(state(stat) == b"R" for stat in self._states)

    def wait(self, deadline_s: float = 5.0) -> None:
        """Wait until what has reached this process is handled: all that was sent to it before can be taken then, and
        what it knows of the graph is complete."""
        deadline = time.monotonic() + deadline_s
        while self.at_work() and time.monotonic() < deadline:
            time.sleep(LOOK_S)

    def close(self) -> None:
        """Close every file."""
        while self._states:
            os.close(self._states.pop())


def state(stat: int) -> bytes:
    """The state of the thread whose stat file this is, such as R, S or D. Raises OSError when it has ended."""
    # It follows the program's name, which may hold any character but ends with the last bracket.
    return os.pread(stat, 512, 0).rpartition(b") ")[2][:1]


class Threads:
    """The threads of a program's processes. Files stay open between looks, which makes a look cheap."""

    def __init__(self, student: Student) -> None:
        self._student = student
        self._open: dict[str, tuple[int, int]] = {}
        self._middleware: set[str] = set()
        self._rested: Activity | None = None
        self.with_middleware = True
        """Whether the middleware's own threads count. They don't where an answer of the program shows what they did."""

    def activity(self) -> Activity | None:
        """What each thread has done so far; None where one of them runs or could run."""
        seen: Activity = {}
        for process in self._student.pids():
            try:
                threads = os.listdir(f"/proc/{process}/task")  # noqa: PTH208
            except OSError:
                continue
            for thread in threads:
                task = f"/proc/{process}/task/{thread}"
                try:
                    stat, schedstat = self._open.get(task) or self._opened(task)
                    if task in self._middleware and not self.with_middleware:
                        continue
                    if state(stat) == b"R":
                        return None
                    seen[task] = os.pread(schedstat, 128, 0)
                except OSError:
                    self._close(task)
        return seen

    def wait_until_still(self, for_s: float, deadline_s: float) -> bool:
        """Wait until no thread has got a CPU for `for_s` seconds; False when it does not come to that in time.

        Packets on the loopback reach the receiving thread before the sender's call returns, and each thread wakes the
        next before it sleeps, so a message that is on its way always shows as a thread that runs, could run or has run.
        """
        deadline = time.monotonic() + deadline_s
        before, since = self.activity(), time.monotonic()
        while time.monotonic() < deadline:
            if before is None or for_s:
                time.sleep(max(for_s / 2, LOOK_S))
            now = self.activity()
            if now is None or now != before:
                before, since = now, time.monotonic()
            elif time.monotonic() - since >= for_s:
                self._rested = now
                return True
        return False

    def stirred(self) -> bool:
        """Whether one of them has got a CPU since they were last found still, or could do with one."""
        return self.activity() != self._rested

    def close(self) -> None:
        """Close every file."""
        for task in list(self._open):
            self._close(task)

    def _opened(self, task: str) -> tuple[int, int]:
        stat = os.open(f"{task}/stat", os.O_RDONLY | os.O_CLOEXEC)
        try:
            self._open[task] = (stat, os.open(f"{task}/schedstat", os.O_RDONLY | os.O_CLOEXEC))
        except OSError:
            os.close(stat)
            raise
        if b"(" + MIDDLEWARE in os.pread(stat, 64, 0):
            self._middleware.add(task)
        return self._open[task]

    def _close(self, task: str) -> None:
        for descriptor in self._open.pop(task, ()):
            os.close(descriptor)
