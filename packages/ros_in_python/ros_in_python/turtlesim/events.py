"""What happens in the turtles' world, as plain values: the world returns them, the node publishes and logs them."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, replace
from enum import Enum

#: One unit of the world in pixels of the window.
PIXELS_PER_UNIT = 45
#: The window is this many pixels wide and high.
WINDOW_PX = 500
#: The time that one tick adds to a turtle's motion, in s. A constant: it is not measured.
DT = 0.016
#: The time between two ticks, in ns.
TICK_NS = 16_000_000
#: A velocity command holds for this long, in ns.
COMMAND_TIMEOUT_NS = 1_000_000_000

# turtlesim writes pi with these digits, and its angles wrap there.
_PI = 3.14159265


def single(value: float) -> float:
    """Return `value` rounded to a float32; what is too large for one becomes infinite."""
    try:
        rounded: float = struct.unpack("f", struct.pack("f", value))[0]
    except OverflowError:
        return math.copysign(math.inf, value)
    return rounded


#: Width and height of the world in units: 11.088889 as a float32.
SIDE = single((WINDOW_PX - 1) / PIXELS_PER_UNIT)
#: x and y of the place where turtle1 starts.
CENTRE = single(SIDE / 2)


def normalized(angle: float) -> float:
    """Return the same angle (rad) within [-pi, pi)."""
    return angle - 2 * _PI * math.floor((angle + _PI) / (2 * _PI))


class LogLevel(Enum):
    """How a log line is marked."""

    INFO = "info"
    WARN = "warn"
    ERROR = "error"


@dataclass(frozen=True)
class LogLine:
    """A line that turtlesim writes into its log."""

    severity: LogLevel
    text: str


@dataclass(frozen=True)
class TurtleSpawned:
    """A turtle has come into the world."""

    turtle: str


@dataclass(frozen=True)
class TurtleKilled:
    """A turtle has left the world."""

    turtle: str


@dataclass(frozen=True)
class PoseReport:
    """Where a turtle is after a tick: units, rad, units/s and rad/s, every number as a float32 holds it.

    `linear_velocity` is the length of the commanded velocity, so it is never negative.
    """

    turtle: str
    x: float
    y: float
    theta: float
    linear_velocity: float
    angular_velocity: float


@dataclass(frozen=True)
class ColorReport:
    """The colour under a turtle's centre, each part 0..255."""

    turtle: str
    r: int
    g: int
    b: int


@dataclass(frozen=True)
class RotationFeedback:
    """How far a rotation still has to go, in rad."""

    turtle: str
    goal: int
    remaining: float


class Outcome(Enum):
    """How a rotation ended."""

    SUCCEEDED = "succeeded"
    CANCELED = "canceled"
    ABORTED = "aborted"


@dataclass(frozen=True)
class RotationEnded:
    """A rotation is over. `delta` (rad) is the heading at its start minus the heading at its end."""

    turtle: str
    goal: int
    outcome: Outcome
    delta: float


Event = LogLine | TurtleSpawned | TurtleKilled | PoseReport | ColorReport | RotationFeedback | RotationEnded


@dataclass(frozen=True)
class Pen:
    """Colour (each part 0..255), width in pixels of the window, and whether it is lifted."""

    r: int = 179
    g: int = 184
    b: int = 255
    width: int = 3
    off: bool = False

    def changed(self, r: int, g: int, b: int, width: int, off: int) -> Pen:
        """Return the pen after a set_pen request: lifting keeps the colour, and a width of 0 means 1."""
        if off:
            return replace(self, off=True)
        return Pen(r, g, b, width or 1)
