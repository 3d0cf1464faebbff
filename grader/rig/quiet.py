"""Whether anything at all happens inside a program, from what the kernel keeps about its threads."""

from __future__ import annotations

import os
import time
from pathlib import Path

#: Process -> thread -> what its schedstat says: ns on a CPU, ns waiting for one, times it got one.
Activity = dict[str, str]


def activity(pid: int) -> Activity | None:
    """The state of every thread of `pid` and of its children; None where one of them runs or could run."""
    seen: Activity = {}
    waiting = [str(pid)]
    while waiting:
        process = waiting.pop()
        try:
            threads = os.listdir(f"/proc/{process}/task")
        except OSError:
            continue
        for thread in threads:
            task = f"/proc/{process}/task/{thread}"
            try:
                stat = Path(task, "stat").read_text()
                seen[task] = Path(task, "schedstat").read_text()
                children = Path(task, "children").read_text()
            except OSError:
                continue
            # The state follows the program's name, which may hold any character but ends with the last bracket.
            if stat.rpartition(")")[2].split()[0] == "R":
                return None
            waiting += children.split()
    return seen


def wait_for_quiet(pid: int, still_s: float, deadline_s: float) -> bool:
    """Wait until no thread of `pid` has got a CPU for `still_s` seconds; False when it never came to that.

    Packets on the loopback reach the receiving thread before the sender's call returns, and each thread wakes the
    next before it sleeps, so a message that is on its way always shows as a thread that runs, could run or has run.
    """
    deadline = time.monotonic() + deadline_s
    before, since = activity(pid), time.monotonic()
    while time.monotonic() < deadline:
        time.sleep(still_s / 2)
        now = activity(pid)
        if now is None or now != before:
            before, since = now, time.monotonic()
        elif time.monotonic() - since >= still_s:
            return True
    return False
