"""How a process of nodes reaches others, how it waits, and what time it is.

A link is all that differs between a process of its own, a web page and a check in simulated time.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable
from typing import Any, Protocol, TypeAlias

Frame: TypeAlias = "dict[str, Any]"
"""What participants tell one another, ready for JSON: `op` says what it is (participant.py)."""


class Link(Protocol):
    """What carries frames to the other participants of a graph, and waits for theirs."""

    @property
    def lock(self) -> threading.Condition:
        """Held while the graph or a queue changes; told whenever something may have become ready."""

    def send(self, frame: Frame, data: bytes = b"") -> None:
        """Hand a frame to every other participant that may want it."""

    def receive(self) -> Iterable[tuple[Frame, bytes]]:
        """Yield the frames that have arrived since the last call."""

    def wait(self, nanoseconds: int | None) -> None:
        """Wait for a frame, for `lock` to be told, or for this long; None stands for as long as it takes.

        Called with `lock` held.
        """

    def breathe(self, looks: bool) -> int:
        """Let frames and signals in, where a program never waits; how long the thread is taken to wait (ns).

        `looks` says that the thread only looks, and that there is nothing.
        """

    def steady(self) -> int:
        """The steady clock (ns)."""

    def system(self) -> int:
        """The system clock (ns since the epoch)."""


class LocalLink:
    """One process, alone, in real time. Threads may wait."""

    def __init__(self) -> None:
        self.lock = threading.Condition(threading.RLock())

    def send(self, frame: Frame, data: bytes = b"") -> None:
        """Nobody else is there."""

    def receive(self) -> Iterable[tuple[Frame, bytes]]:
        """Nobody else says anything."""
        return ()

    def wait(self, nanoseconds: int | None) -> None:
        """Wait for another thread, or for the time."""
        self.lock.wait(None if nanoseconds is None else nanoseconds / 1e9)

    def breathe(self, looks: bool) -> int:
        """Threads and signals come in by themselves."""
        return 0

    def steady(self) -> int:
        """The steady clock (ns)."""
        return time.monotonic_ns()

    def system(self) -> int:
        """The system clock (ns since the epoch)."""
        return time.time_ns()
