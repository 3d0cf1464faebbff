"""What a lighthouse is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    return (
        Scenario("six_seconds", "the first six seconds", duration=6.1, interrupt=True),
        Scenario("minute", "a whole minute", duration=60.1, rate=20.0),
    )
