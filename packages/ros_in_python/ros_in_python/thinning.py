"""Fewer points of a line that keep its shape, as they come or all at once.

The swing-door method: E. H. Bristol, "Swinging door trending: adaptive trend recording?", 1990.
"""

from __future__ import annotations

import math
from collections.abc import Sequence


class SwingDoor:
    """Says which points of a line can be left out: those within the tolerances of a steady change.

    A point is a time, or another number that never falls, and values; there is one tolerance for each value. Each point
    that is kept opens the door: `open`. As long as the line may `end` at the next point instead of the last one, the
    last one is left out.
    """

    def __init__(self, tolerances: Sequence[float]) -> None:
        self._tolerances = tuple(tolerances)
        self._at = 0.0
        self._values: tuple[float, ...] = ()
        self._doors: list[tuple[float, float]] = []

    def open(self, at: float, values: Sequence[float]) -> None:
        """A line begins at this point."""
        self._at, self._values = at, tuple(values)
        self._doors = [(-math.inf, math.inf)] * len(self._tolerances)

    def may_end(self, at: float, values: Sequence[float]) -> bool:
        """Whether a straight line to this point passes near every point since `open`."""
        if at <= self._at:
            pairs = zip(values, self._values, self._tolerances, strict=True)
            return all(abs(value - begin) <= tolerance for value, begin, tolerance in pairs)
        slopes = self._slopes(at, values)
        return all(low <= slope <= high for (low, high), slope in zip(self._doors, slopes, strict=True))

    def passes(self, at: float, values: Sequence[float]) -> None:
        """The line passes near this point."""
        if at <= self._at:
            return
        span = at - self._at
        self._doors = [
            (max(low, slope - tolerance / span), min(high, slope + tolerance / span))
            for (low, high), slope, tolerance in zip(
                self._doors, self._slopes(at, values), self._tolerances, strict=True
            )
        ]

    def _slopes(self, at: float, values: Sequence[float]) -> list[float]:
        return [(value - begin) / (at - self._at) for value, begin in zip(values, self._values, strict=True)]


def thinned(points: Sequence[tuple[float, float]], tolerance: float) -> list[tuple[float, float]]:
    """Return those (time, value) points that keep the curve between them within `tolerance`; `points` are in order."""
    kept = list(points[:1])
    door = SwingDoor([tolerance])
    for at, value in points[1:]:
        if len(kept) > 1 and door.may_end(at, [value]):
            kept[-1] = (at, value)
        else:
            door.open(kept[-1][0], [kept[-1][1]])
            kept.append((at, value))
        door.passes(at, [value])
    return kept
