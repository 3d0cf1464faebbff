"""What a program may use of the hub, and the exception for exceeding it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Literal

#: Why the hub stopped a program. `protocol`: it broke a rule of PROTOCOL.md. `at once`: it sent too much at one moment;
#: `own messages`: the same, on a topic that it subscribes to itself.
Reason = Literal[
    "protocol",
    "message",
    "bytes",
    "messages",
    "at once",
    "own messages",
    "frames",
    "nodes",
    "endpoints",
    "connections",
    "unread",
    "unanswered",
    "wake-ups",
    "cpu",
]


@dataclass(frozen=True)
class HubLimits:
    """How much all processes of a program together may send, create and leave unread during the whole run.

    Sizes are in bytes. No correct program comes close to any limit.
    """

    message_bytes: int = 1_000_000
    """One serialized message, request or response."""
    data_bytes: int = 8_000_000
    """All of them together."""
    messages: int = 20_000
    """The number of these."""
    at_once: int = 1_500
    """Messages and requests at one moment of its clock, including those that stay inside the program."""
    frames: int = 1_000_000
    """Frames of any kind."""
    nodes: int = 200
    """Nodes at the same time."""
    endpoints: int = 4_000
    """Publishers, subscriptions, clients and servers at the same time. A node of rclpy has about ten of its own."""
    connections: int = 64
    """Processes at the same time."""
    all_connections: int = 5_000
    """Processes in total."""
    unread_bytes: int = 16_000_000
    """What is kept for all processes: for those that do not read, and until all are idle."""
    unanswered: int = 10_000
    """Requests of other processes that it leaves unanswered."""
    wake_ups: int = 1_000_000
    """How often several processes may be granted time. A single process gets it in one piece."""
    cpu_s: float = 5.0
    """CPU seconds that taking what they send may cost the hub. 10,000 messages cost it about 0.3 s."""


#: How many frames are handled before the CPU time is looked at again: some take milliseconds each.
FRAMES_PER_LOOK = 100


class Violation(Exception):
    """Raised when a program sends what no correct program sends. `found` exceeds `limit`, unless that is 0."""

    def __init__(self, reason: Reason, text: str, *, found: float = 0, limit: float = 0) -> None:
        super().__init__(text)
        self.reason = reason
        self.text = text
        self.found = found
        self.limit = limit


class HubUsage:
    """What a program has used so far. Each method raises `Violation` if that exceeds `limits`."""

    def __init__(self, limits: HubLimits) -> None:
        self.limits = limits
        self.frames = 0
        self.messages = 0
        self.data_bytes = 0
        self.unread_bytes = 0
        self.connections = 0
        self.wake_ups = 0
        self.cpu_s = self._since = 0.0

    def frame(self) -> None:
        """Count a frame."""
        self.frames += 1
        _check("frames", "frames", self.frames, self.limits.frames)
        if not self.frames % FRAMES_PER_LOOK:
            self.look_at_cpu()

    def data(self, size: int) -> None:
        """Count a message of `size` bytes."""
        self.messages += 1
        self.data_bytes += size
        _check("message", "bytes in one message", size, self.limits.message_bytes)
        _check("bytes", "bytes in all messages together", self.data_bytes, self.limits.data_bytes)
        _check("messages", "messages", self.messages, self.limits.messages)

    def connection(self, alive: int) -> None:
        """Count a connection in addition to `alive` others."""
        self.connections += 1
        _check("connections", "processes", alive + 1, self.limits.connections)
        _check("connections", "processes", self.connections, self.limits.all_connections)

    def wake_up(self) -> None:
        """Count a grant of time."""
        self.wake_ups += 1
        _check("wake-ups", "wake-ups", self.wake_ups, self.limits.wake_ups)

    def begin_taking(self) -> None:
        """Count the CPU time of this thread from here on, in which frames are taken, until `look_at_cpu`."""
        self._since = time.thread_time()

    def look_at_cpu(self) -> None:
        """Check the CPU time in which frames have been taken."""
        now = time.thread_time()
        self.cpu_s, self._since = self.cpu_s + now - self._since, now
        _check("cpu", "CPU seconds of the hub", self.cpu_s, self.limits.cpu_s)

    def nodes(self, count: int) -> None:
        """Check that there may be `count` nodes."""
        _check("nodes", "nodes", count, self.limits.nodes)

    def endpoints(self, count: int) -> None:
        """Check that there may be `count` endpoints."""
        _check("endpoints", "publishers, subscriptions, clients and servers", count, self.limits.endpoints)

    def unread(self, size: int) -> None:
        """Count `size` more bytes that are kept for a process until it reads them; fewer if `size` is negative."""
        self.unread_bytes += size
        if size > 0:
            _check("unread", "unread bytes", self.unread_bytes, self.limits.unread_bytes)

    def unanswered(self, count: int) -> None:
        """Check that `count` requests may be left unanswered."""
        _check("unanswered", "unanswered requests", count, self.limits.unanswered)


def _check(reason: Reason, counted: str, number: float, limit: float) -> None:
    if number > limit:
        raise Violation(reason, f"{number:,} {counted}; the limit is {limit:,}", found=number, limit=limit)
