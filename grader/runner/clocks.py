"""The two clocks of a run: simulated time, which ROS 2 shows, and the computer's time, which Python shows.

The grader is a simulator that runs at 80 % of real time, as simulators do. So a program that measures with the
computer's clock is off by the factor 1.25, visibly and each time the same; and a program that keeps up in real life
keeps up here.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from grader.scenario.scenario import SECOND, START, ComputerTime

#: How much of the computer's time goes by for so much simulated time, by a scenario's `computer_time`.
PACES: dict[ComputerTime, tuple[int, int]] = {"apart": (5, 4), "simulated": (1, 1)}

_CLOCK = struct.Struct("<4siI")


@dataclass(frozen=True)
class Clocks:
    """What the computer's clock shows at each moment of simulated time, and the other way round (ns).

    `began` is what it shows at `START`.
    """

    began: int
    pace: tuple[int, int] = PACES["apart"]

    def computer(self, at: int) -> int:
        """The computer's time at the simulated time `at`; rounded up, so that `simulated` gives exactly `at` again."""
        computer, simulated = self.pace
        return self.began - (START - at) * computer // simulated

    def simulated(self, now: int) -> int:
        """The simulated time when the computer's clock shows `now`."""
        computer, simulated = self.pace
        return START + (now - self.began) * simulated // computer


def clock_message(at: int) -> bytes:
    """The time `at` as a serialized rosgraph_msgs/msg/Clock: a header that says little-endian, seconds, nanoseconds."""
    return _CLOCK.pack(b"\0\1\0\0", *divmod(at, SECOND))
