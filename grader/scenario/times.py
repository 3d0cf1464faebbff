"""Simulated time: its unit and its beginning, and when a reference publisher publishes (s after the start)."""

from __future__ import annotations

import random
from collections.abc import Sequence

from grader.recording.events import SECOND, START

__all__ = ["BEFORE_START", "SECOND", "START", "every", "later", "uneven"]

#: The time of events before the student's program starts.
BEFORE_START = START - SECOND


def every(period: float, seconds: float) -> tuple[float, ...]:
    """Return instants `period` s apart, for `seconds`."""
    return tuple(k * period for k in range(round(seconds / period)))


def uneven(shortest: float, longest: float, count: int, seed: int) -> tuple[float, ...]:
    """Return `count` instants that are between `shortest` and `longest` s apart, the same for each `seed`."""
    chance = random.Random(f"uneven {seed}")
    times = [0.0]
    while len(times) < count:
        times.append(times[-1] + chance.uniform(shortest, longest))
    return tuple(times)


def later(instants: Sequence[int], most: float, seed: int) -> tuple[int, ...]:
    """Delay each instant (ns) by up to `most` s without changing the order; the same for each `seed`."""
    chance = random.Random(f"late {seed}")
    result, at = [], 0
    for instant in instants:
        at = max(at, instant + round(chance.uniform(0.1, 1.0) * most * SECOND))
        result.append(at)
    return tuple(result)
