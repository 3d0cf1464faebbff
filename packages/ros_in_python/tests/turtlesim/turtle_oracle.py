"""An independent turtle: the specification's formulas again, in complex numbers and with y upwards.

A position is x + iy, a velocity forward + i left, so one product with exp(i theta) turns it into the world's frame.
None of the node's code is used here.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field

import numpy as np

W = float(np.float32(499 / 45))
DT = 0.016


def wrap(angle: float) -> float:
    """Return the angle's direction again, in (-pi, pi], by way of the unit circle."""
    return cmath.phase(cmath.rect(1.0, angle))


@dataclass
class OracleTurtle:
    """Poses after every tick, from commands given at ticks."""

    place: complex = complex(5.5444446, 5.5444446)
    heading: float = 0.0
    velocity: complex = 0
    turn: float = 0.0
    commanded_ms: float = 0.0
    goal: float | None = None
    jumps: list[tuple[str, tuple[float, ...]]] = field(default_factory=list)
    hits: int = 0

    def tick(self, now_ms: float) -> tuple[complex, float, float, float]:
        """Do one tick: position, heading, speed, turn."""
        for kind, numbers in self.jumps:
            if kind == "relative":
                linear, angular = numbers
                self.heading += angular
                self.place += cmath.rect(linear, self.heading)
            else:
                x, y, self.heading = numbers
                self.place = complex(x, min(y, W))
        self.jumps.clear()
        if self.goal is not None:
            left = wrap(self.goal - self.heading)
            self.velocity = 0
            if abs(left) < 0.02:
                self.goal, self.turn = None, 0.0
            else:
                self.turn, self.commanded_ms = (1.0 if left >= 0 else -1.0), now_ms
        if now_ms - self.commanded_ms > 1000:
            self.velocity, self.turn = 0, 0.0
        self.heading = wrap(self.heading + DT * self.turn)
        self.place += self.velocity * cmath.exp(1j * self.heading) * DT
        inside = complex(sorted((0, self.place.real, W))[1], sorted((0, self.place.imag, W))[1])
        self.hits += inside != self.place
        self.place = inside
        return self.place, self.heading, abs(self.velocity), self.turn


def circle(turns: int, speed: float, rate: float, start: complex, heading: float) -> tuple[complex, float]:
    """Return the pose after `turns` ticks of constant velocities, as the sum of a geometric series.

    The k-th tick moves along heading + k rate DT, so the path is speed DT e^(i heading) (q + q^2 + … + q^turns) with
    q = e^(i rate DT).
    """
    q = cmath.exp(1j * rate * DT)
    series = turns if abs(q - 1) < 1e-12 else q * (q**turns - 1) / (q - 1)
    return start + speed * DT * cmath.exp(1j * heading) * series, wrap(heading + turns * rate * DT)


def apart(one: float, other: float) -> float:
    """Return the angle between two headings, in rad."""
    return abs(math.remainder(one - other, 2 * math.pi))
