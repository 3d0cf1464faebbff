"""What a thermostat is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario, at
from grader.scenario.numbers import numbers

#: Down and up again, slowly (degrees Celsius). It crosses every limit that a scenario sets, and equals some exactly.
ROOM = (21.0, 20.0, 19.75, 19.5, 19.25, 19.5, 19.75, 20.0, 20.5, 19.75, 19.0, 18.0, 19.0, 21.0, 23.0, 24.0, 22.5)


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    room = numbers("/temperature", [(0.5 + 0.5 * i, value) for i, value in enumerate(ROOM)])
    warm = {"target": 22.5, "margin": 3.0}
    changed = (at(2.7).set_parameter("target", 22.0), at(5.2).set_parameter("margin", 3.0))
    bad = [("target", 30.5), ("target", 4.5), ("margin", -0.5), ("margin", 5.5), ("target", -20.0)]
    refused = tuple(at(1.2 + i).set_parameter(name, value) for i, (name, value) in enumerate(bad))
    ends = [("target", 30.0), ("margin", 5.0), ("target", 5.0), ("margin", 0.0)]
    taken = tuple(at(1.2 + 2 * i).set_parameter(name, value) for i, (name, value) in enumerate(ends))
    types = (at(1.2).set_parameter("target", 22), at(2.2).set_parameter("margin", "wide"))
    read = (at(1.2).get_parameter("target"), at(1.2).get_parameter("margin"))
    return (
        Scenario("defaults", "a room cools down and warms up", room, interrupt=True, rate=20.0),
        Scenario("started", "target 22.5 and margin 3 at the start", room, parameters=warm, rate=20.0),
        Scenario("changed", "target and margin change while it runs", (room, changed), rate=20.0),
        Scenario("refused", "values outside of their ranges", (room, refused), rate=20.0),
        Scenario("ends", "values at the ends of their ranges", (room, taken), rate=20.0),
        Scenario("types", "an integer and a text for a double", (room, types), rate=20.0),
        Scenario("read", "the parameters are read", (room, read), rate=20.0),
    )
