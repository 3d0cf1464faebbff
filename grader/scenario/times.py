"""When a reference publisher publishes: instants in seconds after a scenario's start."""

from __future__ import annotations

import random


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
