"""Where a value stands on an axis, and which values are written at it."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Scale:
    """`low` stands at `start`, `high`, which is greater, at `end` (px)."""

    low: float
    high: float
    start: float
    end: float

    def at(self, value: float) -> float:
        """The place of a value (px)."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def marks(self) -> list[float]:
        """Up to five round values between, 1, 2 or 5 times a power of ten apart."""
        span = self.high - self.low
        step = 10.0 ** math.floor(math.log10(span / 5))
        step *= next((factor for factor in (1, 2, 5) if span / (step * factor) <= 5), 10)
        # A mark is written with the digits of its step: 3 * 0.1 is 0.3.
        digits = max(0, -math.floor(math.log10(step)))
        numbers = range(math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9) + 1)
        return [round(step * number, digits) for number in numbers]


def around(values: list[float], start: float, end: float) -> Scale:
    """A scale for these values, with some room beyond the outermost."""
    low, high = min(values), max(values)
    room = (high - low) * 0.06 or abs(high) * 0.1 or 1.0
    return Scale(low - room, high + room, start, end)
