"""The two clocks of a run: simulated time, which ROS 2 shows, and the computer's time, which Python shows.

The grader is a simulator that runs at 80 % of real time, as simulators do. So a program that measures with the
computer's clock is off by the factor 1.25, visibly and each time the same; and a program that keeps up in real life
keeps up here.
"""

from __future__ import annotations

import struct
from bisect import bisect_right

from grader.scenario.scenario import SECOND, ComputerTime

#: How much of the computer's time goes by for so much simulated time, by a scenario's `computer_time`.
PACES: dict[ComputerTime, tuple[int, int]] = {"apart": (5, 4), "simulated": (1, 1)}

#: How much of the computer's time goes by from one message to the next at least (ns), however near they are in
#: simulated time: a simulator gets slower when much happens, and so does not run away from a node that looks for one
#: message every few milliseconds. And no clock shows the same twice.
BETWEEN_MESSAGES = 10_000_000

_CLOCK = struct.Struct("<4siI")


class Clocks:
    """What the computer's clock shows at each moment of simulated time, and the other way round (ns).

    It is told by `set` when simulated time has been set, or a message was published: at the simulated time `at`, with
    the computer's clock at `now`, as number `stage` of what the hub has published.
    """

    def __init__(self, computer_time: ComputerTime) -> None:
        self._computer, self._simulated = PACES[computer_time]
        self._stages: list[int] = []
        self._moments: list[tuple[int, int]] = []
        self._earliest = 0

    def set(self, at: int, now: int, stage: int, *, message: bool = False) -> None:
        """From number `stage` on, which may be a message, both clocks go on from here."""
        self._stages.append(stage)
        self._moments.append((at, now))
        self._earliest = now + BETWEEN_MESSAGES if message else max(now, self._earliest)

    @property
    def at(self) -> int:
        """The simulated time that was set last."""
        return self._moments[-1][0]

    def computer(self, at: int) -> int:
        """The computer's time at the simulated time `at`; rounded up, so that `simulated` gives exactly `at` again.

        Later than when a message was published last, also if `at` is not.
        """
        begun_at, began = self._moments[0]
        now = began - (begun_at - at) * self._computer // self._simulated
        return max(now, self._earliest)

    def simulated(self, now: int, stage: int) -> int:
        """The simulated time when the computer's clock shows `now` and number `stage` is the last to have come.

        Before it was set for the first time it is 0, as ROS 2 has it.
        """
        found = bisect_right(self._stages, stage)
        if not found:
            return 0
        at, began = self._moments[found - 1]
        then = at + (now - began) * self._simulated // self._computer
        return min(then, self._moments[found][0]) if found < len(self._moments) else then


def clock_message(at: int) -> bytes:
    """The time `at` as a serialized rosgraph_msgs/msg/Clock: a header that says little-endian, seconds, nanoseconds."""
    return _CLOCK.pack(b"\0\1\0\0", *divmod(at, SECOND))
