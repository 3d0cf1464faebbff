"""The grader's side of a run: the two clocks, the hub and its node, and the schedule.

ROS 2 shows simulated time, Python shows the computer's time. The grader is a simulator that runs at 80 %
of real time, as simulators do. So a program that measures time with the computer's clock is off by the factor 1.25,
visibly and in every run; and a program that is fast enough in real life is fast enough here.
"""

from __future__ import annotations

import heapq
import struct
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Protocol

from grader.exercise.exercise import Qos
from grader.scenario.scenario import SECOND, START, ComputerTime
from rmw_lockstep.hub import HubNode, PendingRequest, QosPolicies
from rmw_lockstep.hub.endpoints import DeliveredMessage, Moment
from rmw_lockstep.qos import BEST_EFFORT, RELIABLE, TRANSIENT_LOCAL, VOLATILE

#: How much of the computer's time passes per unit of simulated time, by a scenario's `computer_time`.
PACES: dict[ComputerTime, tuple[int, int]] = {"apart": (5, 4), "simulated": (1, 1)}

#: The least time on the computer's clock between two messages (ns), however close they are in simulated time: a
#: simulator slows down when much happens, and so does not run ahead of a node that looks for one message every few
#: milliseconds. It also gives every message a time of its own.
BETWEEN_MESSAGES = 10_000_000

#: Compatible with every QoS that a publisher can offer.
ACCEPT_ANY = QosPolicies(depth=10_000, reliability=BEST_EFFORT)

_CLOCK = struct.Struct("<4siI")


class Clocks:
    """Maps each moment of simulated time to the computer's time, and back (ns).

    `set` records that simulated time was set, or a message published: at the simulated time `at`, with the computer's
    clock at `now`, as number `stage` of everything the hub has published.
    """

    def __init__(self, computer_time: ComputerTime) -> None:
        self._computer, self._simulated = PACES[computer_time]
        self._stages: list[int] = []
        self._moments: list[tuple[int, int]] = []
        self._earliest = 0

    def set(self, at: int, now: int, stage: int, *, message: bool = False) -> None:
        """Continue both clocks from here, from number `stage` on, which may be the number of a message."""
        self._stages.append(stage)
        self._moments.append((at, now))
        self._earliest = now + BETWEEN_MESSAGES if message else max(now, self._earliest)

    @property
    def at(self) -> int:
        """The simulated time that was set most recently."""
        return self._moments[-1][0]

    def computer(self, at: int) -> int:
        """Return the computer's time at the simulated time `at`; rounded up, so `simulated` returns exactly `at` again.

        It is later than the last message was published, even if `at` is not.
        """
        begun_at, began = self._moments[0]
        now = began - (begun_at - at) * self._computer // self._simulated
        return max(now, self._earliest)

    def simulated(self, now: int, stage: int) -> int:
        """Return the simulated time when the computer's clock shows `now` and number `stage` has arrived last.

        Before it was set for the first time it is 0, as in ROS 2.
        """
        found = bisect_right(self._stages, stage)
        if not found:
            return 0
        at, began = self._moments[found - 1]
        then = at + (now - began) * self._simulated // self._computer
        return min(then, self._moments[found][0]) if found < len(self._moments) else then


def clock_message(at: int) -> bytes:
    """Return `at` as a serialized rosgraph_msgs/msg/Clock: a header for little-endian, seconds, nanoseconds."""
    return _CLOCK.pack(b"\0\1\0\0", *divmod(at, SECOND))


class UnservedRequests(Protocol):
    """What the grader's side asks the hub: the requests for which there was no server."""

    @property
    def unserved(self) -> Sequence[PendingRequest]: ...


@dataclass(frozen=True)
class GraderSide:
    """The hub, the grader's node on it, and both clocks."""

    hub: UnservedRequests
    node: HubNode
    clocks: Clocks

    def at(self, moment: Moment | DeliveredMessage) -> int:
        """Return the simulated time of a moment (ns); moments before it begins count as its beginning."""
        return max(START, self.clocks.simulated(moment.now, moment.stage))


@dataclass
class Schedule:
    """What to do at which simulated time. Actions at the same moment run in the order in which they were planned."""

    _entries: list[tuple[int, int, Callable[[int], None]]] = field(default_factory=list)
    _numbers: count[int] = field(default_factory=count)

    @property
    def due(self) -> int | None:
        """The time of the next action (ns)."""
        return self._entries[0][0] if self._entries else None

    def plan(self, at: int, act: Callable[[int], None]) -> None:
        """Call `act` at that time, with the time."""
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


def hub_qos(qos: Qos) -> QosPolicies:
    """Return the same policies in the hub's form."""
    return QosPolicies(
        depth=qos.depth,
        reliability=BEST_EFFORT if qos.reliability == "best_effort" else RELIABLE,
        durability=TRANSIENT_LOCAL if qos.durability == "transient_local" else VOLATILE,
    )
