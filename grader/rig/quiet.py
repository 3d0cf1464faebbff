"""Whether anything at all happens inside a program, from what the kernel keeps about its threads."""

from __future__ import annotations

import contextlib
import os
import threading
import time

#: Thread -> what its schedstat says: ns on a CPU, ns waiting for one, times it got one.
Activity = dict[str, bytes]

#: How often a program's child processes are looked for.
CHILDREN_EVERY_S = 0.05


class Others:
    """The threads of this process other than the one that made this. Files stay open between looks."""

    def __init__(self) -> None:
        self._own = str(threading.get_native_id())
        self._open: dict[str, int] = {}

    def at_work(self) -> bool:
        """Whether one of them runs, or waits for a CPU to run on."""
        for thread in os.listdir("/proc/self/task"):  # noqa: PTH208
            if thread == self._own:
                continue
            try:
                if thread not in self._open:
                    self._open[thread] = os.open(f"/proc/self/task/{thread}/stat", os.O_RDONLY | os.O_CLOEXEC)
                if os.pread(self._open[thread], 512, 0).rpartition(b") ")[2][:1] == b"R":
                    return True
            except OSError:  # it has ended
                self._let_go(thread)
        return False

    def wait(self, deadline_s: float = 5.0) -> None:
        """Wait until what has reached this process is handled by its threads: what it knows of the graph is then
        complete up to all that was sent before."""
        deadline = time.monotonic() + deadline_s
        while self.at_work() and time.monotonic() < deadline:
            time.sleep(0.0005)

    def close(self) -> None:
        """Close every file."""
        for thread in list(self._open):
            self._let_go(thread)

    def _let_go(self, thread: str) -> None:
        if thread in self._open:
            os.close(self._open.pop(thread))


class Threads:
    """The threads of a program and of its children. Files stay open between looks, which makes a look cheap."""

    def __init__(self, pid: int) -> None:
        self._pid = pid
        self._processes = [str(pid)]
        self._searched = 0.0
        self._open: dict[str, tuple[int, int]] = {}

    def activity(self) -> Activity | None:
        """What each thread has done so far; None where one of them runs or could run."""
        self._find_children()
        seen: Activity = {}
        for process in self._processes:
            try:
                threads = os.listdir(f"/proc/{process}/task")  # noqa: PTH208
            except OSError:
                continue
            for thread in threads:
                task = f"/proc/{process}/task/{thread}"
                try:
                    stat, schedstat = self._open.get(task) or self._opened(task)
                    # The state follows the program's name, which may hold any character but ends with the last bracket.
                    if os.pread(stat, 512, 0).rpartition(b") ")[2][:1] == b"R":
                        return None
                    seen[task] = os.pread(schedstat, 128, 0)
                except OSError:
                    self._close(task)
        return seen

    def still(self) -> bool:
        """Whether no thread is at work, and none got a CPU between two looks."""
        before = self.activity()
        return before is not None and before == self.activity()

    def wait_until_still(self, for_s: float, deadline_s: float) -> bool:
        """Wait until no thread has got a CPU for `for_s` seconds; False when it does not come to that in time.

        Packets on the loopback reach the receiving thread before the sender's call returns, and each thread wakes the
        next before it sleeps, so a message that is on its way always shows as a thread that runs, could run or has run.
        """
        deadline = time.monotonic() + deadline_s
        before, since = self.activity(), time.monotonic()
        while time.monotonic() < deadline:
            time.sleep(for_s / 2)
            now = self.activity()
            if now is None or now != before:
                before, since = now, time.monotonic()
            elif time.monotonic() - since >= for_s:
                return True
        return False

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
        return self._open[task]

    def _close(self, task: str) -> None:
        for descriptor in self._open.pop(task, ()):
            os.close(descriptor)

    def _find_children(self) -> None:
        if time.monotonic() - self._searched < CHILDREN_EVERY_S:
            return
        self._searched = time.monotonic()
        found, waiting = [], [str(self._pid)]
        while waiting:
            process = waiting.pop()
            found.append(process)
            with contextlib.suppress(OSError):
                for thread in os.listdir(f"/proc/{process}/task"):  # noqa: PTH208
                    with contextlib.suppress(OSError), open(f"/proc/{process}/task/{thread}/children") as file:  # noqa: PTH123
                        waiting += file.read().split()
        self._processes = found
