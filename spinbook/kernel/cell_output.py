"""Shows the output of a process in a cell, live, for a limited time and a limited number of lines."""

from __future__ import annotations

import codecs
import re
import sys
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from ros_in_python.ros2.domain import participates
from spinbook.kernel.long_lines import shortened
from spinbook.kernel.process import KeptProcess
from spinbook.kernel.reader_frames import ReaderFrames

#: The number of lines shown at first and, if there are more, at the end.
FIRST_LINES = 60
LAST_LINES = 10
_POLL_S = 0.03
#: The time between two checks whether a process has joined ROS (s).
_LOOK_S = 0.2
#: After this time (s), a process counts as started even if it has not printed anything or joined ROS.
_STARTING_S = 20.0


@dataclass(frozen=True)
class DisplayLimit:
    """How long a process is shown: for so many seconds, until it has printed this text, or until it ends.

    The seconds count from its first line, so that a slow machine shows as much as a fast one. `expects_error` says that
    what goes wrong in it is meant.
    """

    seconds: float
    until: str | None = None
    expects_error: bool = False


class Countdown:
    """Decides when a process has been shown for long enough.

    The seconds count from its first line or, if there is none, from when it joined ROS. Then they are at least as many
    as joining took: if the start takes long, so does the first message.
    """

    def __init__(
        self, bound: DisplayLimit, has_joined: Callable[[], bool], now: Callable[[], float] = time.monotonic
    ) -> None:
        self._bound = bound
        self._has_joined = has_joined
        self._now = now
        self._began = now()
        self._joined: float | None = None
        self._first_line: float | None = None

    def is_over(self, has_printed: bool) -> bool:
        """Return whether the time is over, when polled; `has_printed` says whether the process has printed anything
        yet.
        """
        now = self._now()
        if self._first_line is None and has_printed:
            self._first_line = now
        if self._first_line is not None:
            return now - self._first_line >= self._bound.seconds
        return now >= self._end_of_silence(now)

    def _end_of_silence(self, now: float) -> float:
        if self._joined is None and self._has_joined():
            self._joined = now
        if self._joined is None:
            return self._began + max(_STARTING_S, self._bound.seconds)
        return self._joined + max(self._bound.seconds, self._joined - self._began)

    @property
    def silent_s(self) -> float:
        """How long (s) nothing has been printed, counted from when the process joined ROS, if it has."""
        return self._now() - (self._began if self._joined is None else self._joined)


def joins(process: KeptProcess, domain: int) -> Callable[[], bool]:
    """Return a function that says whether a process, or one that it started, takes part in the ROS domain yet.

    The function checks only now and then, because it goes through all processes of the machine.
    """
    looked = time.monotonic()

    def has_joined() -> bool:
        nonlocal looked
        if time.monotonic() - looked < _LOOK_S:
            return False
        looked = time.monotonic()
        return participates(domain, process.descendants())

    return has_joined


class OutputPrinter:
    """Prints lines as they arrive; if there are very many, only the first and, at the end, the last."""

    def __init__(self, short: Callable[[str], str] = shortened) -> None:
        self._short = short
        self._last: deque[str] = deque(maxlen=LAST_LINES)
        self._count = 0
        self._part = ""
        self._lost = False
        # A character may arrive in two pieces, too.
        self._decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self._frames = ReaderFrames()
        self._left_out = 0
        self.seen = ""
        """The last output, to find a text in it."""

    @property
    def has_any(self) -> bool:
        """Whether anything has been printed."""
        return bool(self.seen)

    def add(self, data: bytes, dropped: int = 0) -> None:
        """Add output; `dropped` bytes before it were lost."""
        self._lost = self._lost or dropped > 0
        text = self._decoder.decode(data)
        # A text that arrives in two pieces is found, too.
        self.seen = self.seen[-1000:] + text
        *lines, self._part = (self._part + text).split("\n")
        shown = list(self._frames.shown(lines))
        self._left_out += len(lines) - len(shown)
        for line in shown:
            self._line(line)
        sys.stdout.flush()

    def _line(self, line: str) -> None:
        self._count += 1
        if self._count <= FIRST_LINES:
            print(self._short(line.rstrip("\r")))
        else:
            self._last.append(line)

    def end(self, total_lines: int, rest_is: str) -> None:
        """Print the last lines. `rest_is` says where the omitted lines can be read."""
        if self._part:
            self._line(self._part)
            self._part = ""
        hidden = max(self._count, total_lines - self._left_out) - FIRST_LINES - len(self._last)
        if hidden > 0 or self._lost:
            print(f"… {hidden:,} more lines{rest_is} …")
        for line in self._last:
            print(self._short(line.rstrip("\r")))
        sys.stdout.flush()


#: Matches the message of `never_appeared`.
NEVER_APPEARED = re.compile(r"^— the text (.+) did not appear within ([\d.]+) s —$", re.MULTILINE)


def never_appeared(bound: DisplayLimit) -> str:
    """Return the message that the expected text was not printed in time; `NEVER_APPEARED` matches it."""
    return f"— the text {bound.until!r} did not appear within {bound.seconds:g} s —"


def show_for(
    process: KeptProcess, bound: DisplayLimit, rest_is: str, has_joined: Callable[[], bool], short: Callable[[str], str]
) -> None:
    """Show what a process prints until it ends, or until its time is up; then say what is missing.

    `has_joined` says whether the process takes part in ROS yet (see `joins`), `short` shortens lines that are too long.
    """
    shown = OutputPrinter(short)
    countdown = Countdown(bound, has_joined)
    over = came = False
    while not over:
        shown.add(*process.read())
        over = not process.status.running or countdown.is_over(shown.has_any)
        came = bound.until is not None and bound.until in shown.seen
        if came:
            break
        if not over:
            time.sleep(_POLL_S)
    shown.end(process.status.lines, rest_is)
    if bound.until is not None and not came and process.status.exit in (None, 0):
        print(never_appeared(bound))
    elif process.status.running and not shown.has_any:
        print(f"— nothing arrived in {countdown.silent_s:.0f} s —")


def show_rest(process: KeptProcess, seconds: float) -> None:
    """Show what a process that was asked to end still prints, for at most this many seconds."""
    shown = OutputPrinter()
    deadline = time.monotonic() + seconds
    while True:
        shown.add(*process.read())
        if not process.status.running or time.monotonic() >= deadline:
            break
        time.sleep(_POLL_S)
    shown.end(process.status.lines, "")


def in_short(text: str, first: int = FIRST_LINES, last: int = LAST_LINES) -> str:
    """Return a long log with its middle left out."""
    lines = [shortened(line) for line in text.rstrip("\n").split("\n")]
    if len(lines) <= first + last:
        return "\n".join(lines)
    left_out = len(lines) - first - last
    return "\n".join([*lines[:first], f"… {left_out:,} more lines …", *lines[-last:]])
