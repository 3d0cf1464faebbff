"""Shows in a cell what a process prints, while it prints it, for a bounded time and a bounded number of lines."""

from __future__ import annotations

import re
import sys
import time
from collections import deque
from dataclasses import dataclass

from spinbook.runtime.process import KeptProcess

#: Lines shown as they come, and lines kept for the end when more come.
FIRST_LINES = 60
LAST_LINES = 10
_POLL_S = 0.03


@dataclass(frozen=True)
class Bound:
    """How long a process is shown: for so many seconds, or until it has printed this text, or until it ends."""

    seconds: float
    until: str | None = None


class Shown:
    """Prints lines as they come; of very many it prints the first and, at the end, the last."""

    def __init__(self, first: int = FIRST_LINES, last: int = LAST_LINES) -> None:
        self._first = first
        self._last: deque[str] = deque(maxlen=last)
        self._count = 0
        self._part = ""
        self._lost = False
        self.seen = ""
        """The last lines, for who waits for a text in them."""

    def add(self, data: bytes, dropped: int = 0) -> None:
        """Take in more output; `dropped` bytes before it were too many to keep."""
        self._lost = self._lost or dropped > 0
        text = self._part + data.decode(errors="replace")
        # What comes in two pieces is found as well.
        self.seen = self.seen[-1000:] + data.decode(errors="replace")
        *lines, self._part = text.split("\n")
        for line in lines:
            self._line(line)
        sys.stdout.flush()

    def _line(self, line: str) -> None:
        self._count += 1
        if self._count <= self._first:
            print(line.rstrip("\r"))
        else:
            self._last.append(line)

    def end(self, total_lines: int, rest_is: str) -> None:
        """Print what was held back. `rest_is` tells where the lines between can be read."""
        if self._part:
            self._line(self._part)
            self._part = ""
        hidden = max(self._count, total_lines) - self._first - len(self._last)
        if hidden > 0 or self._lost:
            print(f"… {hidden:,} more lines{rest_is} …")
        for line in self._last:
            print(line.rstrip("\r"))
        sys.stdout.flush()


#: What is said where a text was waited for in vain: see `never_came`.
NEVER_CAME = re.compile(r"^— the text (.+) did not come within ([\d.]+) s —$", re.MULTILINE)


def never_came(bound: Bound) -> str:
    """Say that the text a cell waited for was not printed in its time; `NEVER_CAME` finds it again."""
    return f"— the text {bound.until!r} did not come within {bound.seconds:g} s —"


def show_for(process: KeptProcess, bound: Bound, rest_is: str) -> None:
    """Show what a process prints until it ends, or until its time is up; then it says which text never came."""
    shown = Shown()
    deadline = time.monotonic() + bound.seconds
    came = False
    while True:
        shown.add(*process.read())
        came = bound.until is not None and bound.until in shown.seen
        if came or not process.status.running or time.monotonic() >= deadline:
            break
        time.sleep(_POLL_S)
    shown.end(process.status.lines, rest_is)
    if bound.until is not None and not came:
        print(never_came(bound))


def in_short(text: str, first: int = FIRST_LINES, last: int = LAST_LINES) -> str:
    """A long log with its middle left out."""
    lines = text.rstrip("\n").split("\n")
    if len(lines) <= first + last:
        return "\n".join(lines)
    left_out = len(lines) - first - last
    return "\n".join([*lines[:first], f"… {left_out:,} more lines …", *lines[-last:]])
