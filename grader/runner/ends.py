"""What the grader's side of a scripted scenario needs from a run, and the schedule of what is still to do."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count

from grader.exercise.exercise import Qos
from grader.runner.clocks import Clocks
from grader.scenario.scenario import SECOND, START
from rmw_lockstep.hub import Hub, HubNode
from rmw_lockstep.hub import Qos as HubQos
from rmw_lockstep.hub.ends import Moment
from rmw_lockstep.hub.qos import BEST_EFFORT, RELIABLE, TRANSIENT_LOCAL, VOLATILE


@dataclass(frozen=True)
class Ends:
    """The hub, the grader's node on it, and both clocks."""

    hub: Hub
    node: HubNode
    clocks: Clocks

    def at(self, moment: Moment) -> int:
        """Return the simulated time of a moment (ns); anything before simulated time begins counts as its beginning."""
        return max(START, self.clocks.simulated(moment.now, moment.stage))


@dataclass
class Schedule:
    """What to do at which simulated time; at the same moment, in the order in which it was planned."""

    _entries: list[tuple[int, int, Callable[[int], None]]] = field(default_factory=list)
    _numbers: count[int] = field(default_factory=count)

    @property
    def due(self) -> int | None:
        """When the next thing is to be done (ns)."""
        return self._entries[0][0] if self._entries else None

    def plan(self, at: int, act: Callable[[int], None]) -> None:
        """Call `act` at that time; `act` gets the time."""
        heapq.heappush(self._entries, (at, next(self._numbers), act))

    def act(self, now: int) -> bool:
        """Do what is due by `now` (ns). Return whether there was anything."""
        found = False
        while self._entries and self._entries[0][0] <= now:
            _, _, act = heapq.heappop(self._entries)
            act(now)
            found = True
        return found


def nanoseconds(seconds: float) -> int:
    """Return seconds as nanoseconds."""
    return round(seconds * SECOND)


def hub_qos(qos: Qos) -> HubQos:
    """Return the same policies in the hub's form."""
    return HubQos(
        depth=qos.depth,
        reliability=BEST_EFFORT if qos.reliability == "best_effort" else RELIABLE,
        durability=TRANSIENT_LOCAL if qos.durability == "transient_local" else VOLATILE,
    )
