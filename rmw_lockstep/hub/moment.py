"""What a program sends at one moment of its clock: a program that answers its own messages never gets past it."""

from __future__ import annotations

from collections import Counter

from rmw_lockstep.hub.frames import PUBLISHER, EndPoint
from rmw_lockstep.hub.graph import Graph
from rmw_lockstep.hub.limits import Limits, Reason, Violation

#: An end point that sent less than this part of everything is not what the program is busy with.
SHARE = 20


class AtOnce:
    """Counts the messages and requests of all processes at the current moment, by the end points that sent them."""

    def __init__(self, graph: Graph, limits: Limits) -> None:
        """`graph` tells who listens to what is sent."""
        self._graph, self._limit = graph, limits.at_once
        self._now = 0
        self._total = 0
        self._sent: Counter[int] = Counter()

    def begin(self) -> None:
        """Count from 0: the hub has published something, which the program may answer."""
        self._total = 0
        self._sent.clear()

    def count(self, sender: EndPoint, now: int, number: int = 1) -> None:
        """Count what was sent at the time `now` (ns). Raises `Violation` when it is too much."""
        if now != self._now:
            self._now = now
            self.begin()
        self._total += number
        self._sent[sender.id] += number
        if self._total > self._limit:
            raise self._violation()

    def _violation(self) -> Violation:
        """Say what is too much. It names all that the program is busy with: which comes last may be chance."""
        busy = self._busy()
        reason: Reason = "own messages" if any(map(self._is_heard_inside, busy)) else "at once"
        names = " and ".join(sorted({one.name for one in busy}))
        return Violation(reason, names, found=self._total, limit=self._limit)

    def _busy(self) -> list[EndPoint]:
        found = self._graph.end_points
        return [found[number] for number, sent in self._sent.items() if sent * SHARE >= self._limit and number in found]

    def _is_heard_inside(self, sender: EndPoint) -> bool:
        """Return whether the program itself listens to this publisher."""
        return sender.kind == PUBLISHER and any(reader.process for reader in self._graph.readers(sender))
