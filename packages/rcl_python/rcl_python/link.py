"""How a process of nodes reaches others, how it waits, and how it gets the time.

A link is the only thing that differs between a process of its own, a web page and a check in simulated time.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable
from typing import Any, Protocol, TypeAlias

Frame: TypeAlias = "dict[str, Any]"
"""What participants send each other, ready for JSON: `op` says what it is (participant.py)."""


class Link(Protocol):
    """Carries frames to the other participants of a graph, and waits for theirs."""

    @property
    def lock(self) -> threading.Condition:
        """Held while the graph or a queue changes; notified whenever something may have become ready."""

    def send(self, frame: Frame, data: bytes = b"") -> None:
        """Hand a frame to every other participant that may want it."""

    def receive(self) -> Iterable[tuple[Frame, bytes]]:
        """Yield the frames that have arrived since the last call."""

    def wait(self, nanoseconds: int | None) -> None:
        """Wait for a frame, for `lock` to be notified, or for this long; None means without a limit.

        Called with `lock` held.
        """

    def breathe(self, looks: bool, news: bool) -> int:
        """Let frames and signals in, where a program never waits; how long the thread is taken to wait for news (ns).

        `looks` says that the thread only looks, `news` that something from outside is ready.
        """

    def steady(self) -> int:
        """Return the steady clock (ns)."""

    def system(self) -> int:
        """Return the system clock (ns since the epoch)."""


class LocalLink:
    """One process, alone, in real time. Threads may wait."""

    def __init__(self) -> None:
        self.lock = threading.Condition(threading.RLock())

    def send(self, frame: Frame, data: bytes = b"") -> None:
        """Do nothing: there is no other process."""

    def receive(self) -> Iterable[tuple[Frame, bytes]]:
        """Yield nothing: there is no other process."""
        return ()

    def wait(self, nanoseconds: int | None) -> None:
        """Wait for another thread, or until the time is up."""
        self.lock.wait(None if nanoseconds is None else nanoseconds / 1e9)

    def breathe(self, looks: bool, news: bool) -> int:
        """Threads and signals come in by themselves."""
        return 0

    def steady(self) -> int:
        """Return the steady clock (ns)."""
        return time.monotonic_ns()

    def system(self) -> int:
        """Return the system clock (ns since the epoch)."""
        return time.time_ns()
