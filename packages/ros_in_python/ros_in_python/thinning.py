"""Fewer points of a line that keep its shape, as they come or all at once.

The swing-door method: E. H. Bristol, "Swinging door trending: adaptive trend recording?", 1990.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence


class SwingDoor:
    """Says which points of a line can be left out: those within the tolerances of a steady change.

    A point is a time, or another number that never falls, and values; there is one tolerance for each value. The last
    point that stays before the newest one opens the door: straight lines from there that pass near all points since.
    """

    def __init__(self, tolerances: Sequence[float]) -> None:
        self._tolerances = tuple(tolerances)
        self._latest: tuple[float, tuple[float, ...]] | None = None
        self._hinge: tuple[float, tuple[float, ...]] | None = None
        self._doors: list[tuple[float, float]] = []

    def replaces_latest(self, at: float, values: Sequence[float], is_corner: bool = False) -> bool:
        """Take the next point; return whether the one before it can be left out. A corner stays in any case."""
        can_replace = not is_corner and self._may_end(at, values)
        if not can_replace:
            self._hinge, self._doors = self._latest, [(-math.inf, math.inf)] * len(self._tolerances)
        self._pass(at, values)
        self._latest = at, tuple(values)
        return can_replace

    def _may_end(self, at: float, values: Sequence[float]) -> bool:
        """Return whether a straight line from the hinge to this point passes near every point between."""
        if self._hinge is None:
            return False
        if at <= self._hinge[0]:
            pairs = zip(values, self._hinge[1], self._tolerances, strict=True)
            return all(abs(value - begin) <= tolerance for value, begin, tolerance in pairs)
        slopes = self._slopes(self._hinge, at, values)
        return all(low <= slope <= high for (low, high), slope in zip(self._doors, slopes, strict=True))

    def _pass(self, at: float, values: Sequence[float]) -> None:
        """Close the door as far as a line that passes near this point allows."""
        if self._hinge is None or at <= self._hinge[0]:
            return
        span, slopes = at - self._hinge[0], self._slopes(self._hinge, at, values)
        self._doors = [
            (max(low, slope - tolerance / span), min(high, slope + tolerance / span))
            for (low, high), slope, tolerance in zip(self._doors, slopes, self._tolerances, strict=True)
        ]

    def _slopes(self, hinge: tuple[float, tuple[float, ...]], at: float, values: Sequence[float]) -> list[float]:
        return [(value - begin) / (at - hinge[0]) for value, begin in zip(values, hinge[1], strict=True)]


def thinned(points: Iterable[tuple[float, float]], tolerance: float) -> list[tuple[float, float]]:
    """Return those (time, value) points that keep the curve between them within `tolerance`; `points` are in order."""
    kept: list[tuple[float, float]] = []
    door = SwingDoor([tolerance])
    for at, value in points:
        if door.replaces_latest(at, [value]):
            kept.pop()
        kept.append((at, value))
    return kept
