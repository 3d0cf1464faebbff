"""When a reference publisher publishes: instants in seconds after a scenario's start."""

from __future__ import annotations

import random
from collections.abc import Sequence

from grader.scenario.scenario import SECOND


def every(period: float, seconds: float) -> tuple[float, ...]:
    """Instants `period` s apart, for `seconds`."""
    return tuple(k * period for k in range(round(seconds / period)))


def uneven(shortest: float, longest: float, count: int, seed: int) -> tuple[float, ...]:
    """`count` instants that lie between `shortest` and `longest` s apart, the same for each `seed`."""
    chance = random.Random(f"uneven {seed}")
    times = [0.0]
    while len(times) < count:
        times.append(times[-1] + chance.uniform(shortest, longest))
    return tuple(times)


def later(instants: Sequence[int], most: float, seed: int) -> tuple[int, ...]:
    """Each instant (ns) up to `most` s later, none before the one that comes before it; the same for each `seed`."""
    chance = random.Random(f"late {seed}")
    result, at = [], 0
    for instant in instants:
        at = max(at, instant + round(chance.uniform(0.1, 1.0) * most * SECOND))
        result.append(at)
    return tuple(result)
