"""What a speed limit is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

import math

from grader.scenario import Scenario
from grader.scenario.numbers import chosen, numbers, placed, wave
from grader.scenario.times import every

WANTED = "/wanted_speed"


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    times = every(0.1, 2.0)
    gentle = numbers(WANTED, wave(0.9, times))
    streams = {
        "gentle": ("speeds within the limit", gentle),
        "too_fast": ("speeds up to 3 m/s", numbers(WANTED, chosen(0.5, 3.0, times, seed))),
        "backwards": ("speeds down to -3 m/s", numbers(WANTED, chosen(-3.0, -0.5, times, seed))),
        "not_a_number": ("a speed that is not a number", placed(gentle, 7, math.nan)),
    }
    return tuple(Scenario(name, title, stream, interrupt=name == "gentle") for name, (title, stream) in streams.items())
