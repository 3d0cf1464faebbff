"""Detects whether anything happens inside a program, from what the kernel records about its threads."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from grader.runner.student import Stopped, Student

#: Thread -> what its schedstat says: ns on a CPU, ns waiting for one, times it got one.
Activity = dict[str, bytes]

#: How the middleware names its threads, and those of them that listen on a socket.
MIDDLEWARE, RECEIVER = b"dds.", "dds.udp"

#: How long to wait between two looks for the end of something that takes less than a millisecond (s).
LOOK_S = 0.0001


class Receivers:
    """The threads of this process that receive for the middleware: all that exist when this is created."""

    def __init__(self) -> None:
        self._states = [
            os.open(f"/proc/self/task/{thread}/stat", os.O_RDONLY | os.O_CLOEXEC)
            for thread in os.listdir("/proc/self/task")  # noqa: PTH208
            if Path(f"/proc/self/task/{thread}/comm").read_text().startswith(RECEIVER)
        ]
        assert self._states, "the middleware has no thread of its own"

    def at_work(self) -> bool:
        """Return whether one of them runs, or waits for a CPU."""
        return any(state(stat) == b"R" for stat in self._states)

    def wait(self, deadline_s: float = 5.0) -> None:
        """Wait until everything that has reached this process is handled: then all messages sent to it before can be
        taken, and its knowledge of the graph is complete."""
        deadline = time.monotonic() + deadline_s
        while self.at_work() and time.monotonic() < deadline:
            time.sleep(LOOK_S)

    def close(self) -> None:
        """Close every file."""
        while self._states:
            os.close(self._states.pop())


def state(stat: int) -> bytes:
    """Return the state of the thread whose stat file this is, such as R, S or D. Raises OSError if it has ended."""
    # It follows the program's name, which may hold any character but ends with the last bracket.
    return os.pread(stat, 512, 0).rpartition(b") ")[2][:1]


class _Thread(NamedTuple):
    """The open files of one thread: its state, and how much CPU it has got."""

    stat: int
    schedstat: int
    of_the_middleware: bool

    @classmethod
    def of(cls, name: str, folder: int) -> _Thread:
        """Open the files of a thread. Raises OSError if it has ended."""
        stat = os.open(f"{name}/stat", os.O_RDONLY | os.O_CLOEXEC, dir_fd=folder)
        try:
            schedstat = os.open(f"{name}/schedstat", os.O_RDONLY | os.O_CLOEXEC, dir_fd=folder)
        except OSError:
            os.close(stat)
            raise
        return cls(stat, schedstat, b"(" + MIDDLEWARE in os.pread(stat, 64, 0))

    def close(self) -> None:
        os.close(self.stat)
        os.close(self.schedstat)


class _Process:
    """The threads of one process. The folder's number of links shows when it has to be read again."""

    def __init__(self, pid: int) -> None:
        self._folder = os.open(f"/proc/{pid}/task", os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        self._links = 0
        self._threads: dict[str, _Thread] = {}

    def threads(self) -> dict[str, _Thread]:
        """Return the current threads, by number. Raises OSError if the process has ended."""
        links = os.fstat(self._folder).st_nlink
        if links != self._links:
            self._read(links)
        return self._threads

    def _read(self, links: int) -> None:
        names = set(os.listdir(self._folder))  # noqa: PTH208
        for ended in self._threads.keys() - names:
            self._threads.pop(ended).close()
        for name in names - self._threads.keys():
            with contextlib.suppress(OSError):
                self._threads[name] = _Thread.of(name, self._folder)
        # Linux counts two links, and one for each thread. If that does not hold, the folder is read each time.
        self._links = links if links == len(self._threads) + 2 else 0

    def ended(self, name: str) -> None:
        """Note that a thread has ended; another may have begun, which the number of links would not show."""
        self._threads.pop(name).close()
        self._links = 0

    def close(self) -> None:
        os.close(self._folder)
        while self._threads:
            self._threads.popitem()[1].close()


class Threads:
    """The threads of a program's processes. Files stay open between looks, which makes looking cheap."""

    def __init__(self, pids: Callable[[], Collection[int]]) -> None:
        """`pids` returns the ids of the current processes."""
        self._pids = pids
        self._processes: dict[int, _Process] = {}
        self._last_idle: Activity | None = None
        self.with_middleware = True
        """Whether the middleware's own threads count as the program's activity. They don't if an answer of the program
        shows what they did."""

    def activity(self) -> Activity | None:
        """Return what each thread has done so far; None if one of them runs or is runnable."""
        seen: Activity = {}
        for process, name, thread in self._all():
            if thread.of_the_middleware and not self.with_middleware:
                continue
            try:
                if state(thread.stat) == b"R":
                    return None
                seen[name] = os.pread(thread.schedstat, 128, 0)
            except OSError:
                process.ended(name)
        return seen

    def at_work(self) -> bool:
        """Return whether one runs, or waits for a CPU or the disk; the middleware's own threads count here, too."""
        for process, name, thread in self._all():
            try:
                if state(thread.stat) in (b"R", b"D"):
                    return True
            except OSError:
                process.ended(name)
        return False

    def _all(self) -> list[tuple[_Process, str, _Thread]]:
        pids = self._pids()
        for pid in self._processes.keys() - pids:
            self._processes.pop(pid).close()
        found = []
        for pid in pids:
            with contextlib.suppress(OSError):
                process = self._processes[pid] = self._processes.get(pid) or _Process(pid)
                found += [(process, name, thread) for name, thread in process.threads().items()]
        return found

    def wait_until_idle(self, for_s: float, deadline_s: float) -> bool:
        """Wait until no thread has got a CPU for `for_s` seconds; return False if that does not happen in time.

        Packets on the loopback reach the receiving thread before the sender's call returns, and each thread wakes the
        next one before it sleeps, so a message in transit always shows as a thread that runs, is runnable or has run.
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
                self._last_idle = now
                return True
        return False

    def has_run(self) -> bool:
        """Return whether one of them has got a CPU since they were last found idle, or is waiting for one."""
        return self.activity() != self._last_idle

    def close(self) -> None:
        """Close every file."""
        while self._processes:
            self._processes.popitem()[1].close()


@dataclass(frozen=True)
class Watch:
    """The student's program with its threads, and the threads by which the runner receives what it sends."""

    student: Student
    threads: Threads
    receivers: Receivers

    def close(self) -> None:
        """Stop looking."""
        self.threads.close()
        self.receivers.close()


#: The longest time between two looks that counts (s): a runner that did not run itself saw nothing. On a machine that
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
    """The time in which neither the program nor the runner has anything to do but wait (s), since this was made.

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
