"""The numbers the turtles' world is made of, in the precision that turtlesim uses for each."""

from __future__ import annotations

import math
import struct

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
    """`value` as a float32 holds it; what is too large for one becomes infinite."""
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
    """The same angle (rad) within [-pi, pi)."""
    return angle - 2 * _PI * math.floor((angle + _PI) / (2 * _PI))
