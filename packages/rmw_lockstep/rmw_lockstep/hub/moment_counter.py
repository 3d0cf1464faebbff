"""Limits what a program sends at one moment of its clock: one that answers its own messages never leaves it."""

from __future__ import annotations

from collections import Counter

from rmw_lockstep.hub.frames import PUBLISHER, EndpointFrame
from rmw_lockstep.hub.graph import HubGraph
from rmw_lockstep.hub.limits import HubLimits, Reason, Violation

#: Blame only topics and services with at least 1/SHARE of the limit.
SHARE = 20

#: If there are none, name this many: those with the most messages.
NAMED = 3


class MomentCounter:
    """Counts the messages and requests of all processes at the current moment, by their topics and services."""

    def __init__(self, graph: HubGraph, limits: HubLimits) -> None:
        """`graph` knows who subscribes to what."""
        self._graph, self._limit = graph, limits.at_once
        self._now = 0
        self._total = 0
        self._sent: Counter[str] = Counter()
        self._senders: dict[str, EndpointFrame] = {}

    def begin(self) -> None:
        """Count from 0 again: the hub has published something, which the program may answer."""
        self._total = 0
        self._sent.clear()
        self._senders.clear()

    def count(self, sender: EndpointFrame, now: int, number: int = 1) -> None:
        """Count what was sent at the time `now` (ns). Raises `Violation` if it is too much.

        A report of nothing counts as one message: it, too, takes memory.
        """
        number = max(1, number)
        if now != self._now:
            self._now = now
            self.begin()
        self._total += number
        self._sent[sender.name] += number
        self._senders[sender.name] = sender
        if self._total > self._limit:
            raise self._violation()

    def _violation(self) -> Violation:
        """Return the violation. It names everything that the program is busy with: which comes last may be random."""
        busy = sorted(self._busy())
        reason: Reason = "own messages" if any(map(self._is_heard_inside, busy)) else "at once"
        return Violation(reason, " and ".join(busy), found=self._total, limit=self._limit)

    def _busy(self) -> list[str]:
        enough = [name for name, sent in self._sent.items() if sent * SHARE >= self._limit]
        return enough or sorted(self._sent, key=lambda name: (-self._sent[name], name))[:NAMED]

    def _is_heard_inside(self, name: str) -> bool:
        """Return whether the program itself subscribes to this topic."""
        sender = self._senders[name]
        return sender.kind == PUBLISHER and any(reader.process for reader in self._graph.readers(sender))
