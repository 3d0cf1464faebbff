"""What a bottling line is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Program, Scenario, at
from grader.scenario.numbers import numbers

SCALE, SORTER = "bottle_scale.py", "bottle_sorter.py"

#: Bottles, some of them at the borders of full (g).
WEIGHTS = (500.0, 495.0, 489.0, 490.0, 510.0, 511.0, 505.0, 120.0, 500.0)


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    bottles = numbers("/weight", [(0.55 + 0.5 * i, weight) for i, weight in enumerate(WEIGHTS)])
    few = numbers("/weight", [(0.55, 500.0), (1.55, 480.0), (6.05, 500.0)])
    comes_back = (at(1.8).kill(SCALE), at(5.8).start(SCALE))
    late_scale = (Program(SCALE, starts=3.0), Program(SORTER))
    late_sorter = (Program(SCALE), Program(SORTER, starts=1.0))
    return (
        Scenario("line", "nine bottles", bottles, duration=5.0, interrupt=True, rate=20.0),
        Scenario("pause", "no bottle for 4.5 s", few, duration=9.0, rate=20.0),
        Scenario("nothing", "no bottle at all", duration=7.0, rate=20.0),
        Scenario(
            "scale_ends", "the scale is killed, and comes back", (bottles, few[2], comes_back), duration=9.0, rate=20.0
        ),
        Scenario("scale_late", "the scale starts after 3 s", few, programs=late_scale, duration=9.0, rate=20.0),
        Scenario("sorter_late", "the sorter starts after 1 s", few, programs=late_sorter, duration=9.0, rate=20.0),
    )
