"""How much memory a command and all that it starts take while they run."""

from __future__ import annotations

import contextlib
import re
import threading
from dataclasses import dataclass
from pathlib import Path

import psutil

#: A look takes 50 ms of CPU time while eight submissions are graded: more often, it would slow what it measures.
EVERY_S = 3.0


@dataclass
class Memory:
    """The peaks so far, in MB. `together` is PSS, in which memory that processes share counts once; `largest` is the
    RSS of one process.
    """

    together: float = 0.0
    largest: float = 0.0
    processes: int = 0


class Watched:
    """Looks at a process and all its descendants every few seconds. Use it as a context manager."""

    def __init__(self, pid: int) -> None:
        self.memory = Memory()
        self._root = psutil.Process(pid)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._look_on, daemon=True)

    def __enter__(self) -> Watched:
        self._thread.start()
        return self

    def __exit__(self, *fault: object) -> None:
        self._stop.set()
        self._thread.join()

    def _look_on(self) -> None:
        while not self._stop.wait(EVERY_S):
            shares, largest = 0.0, 0.0
            with contextlib.suppress(psutil.Error):
                every = [self._root, *self._root.children(recursive=True)]
                for process in every:
                    pss, rss = _megabytes(process.pid)
                    shares, largest = shares + pss, max(largest, rss)
                self.memory.processes = max(self.memory.processes, len(every))
            self.memory.together = max(self.memory.together, shares)
            self.memory.largest = max(self.memory.largest, largest)


def _megabytes(pid: int) -> tuple[float, float]:
    """PSS and RSS of a process: proc(5), smaps_rollup. 0 if it is gone."""
    try:
        rollup = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii")
    except OSError:
        return 0.0, 0.0
    found = dict(re.findall(r"^(Pss|Rss):\s+(\d+) kB", rollup, re.MULTILINE))
    return int(found.get("Pss", 0)) / 1024, int(found.get("Rss", 0)) / 1024
