"""What a departure board is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario, at, before_start


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    train = (at(0.5).publish("/destination", data="Graz"), at(1.0).publish("/delay", data=5))
    delays = tuple(at(1.0 + i).publish("/delay", data=delay) for i, delay in enumerate((5, 5, 7, 0, -2, 3)))
    late = at(2.0).subscribe("/board", name="late", durability="transient_local")
    latest = at(6.5).subscribe("/board", name="latest", durability="transient_local")
    known = before_start.publish("/destination", data="Linz")
    trains = tuple(at(i).publish("/destination", data=name) for i, name in ((1.0, "Wien"), (2.0, "Wien"), (3.0, "Ulm")))
    return (
        Scenario("one_train", "a destination, then a delay", train, interrupt=True, rate=20.0),
        Scenario("passenger", "somebody subscribes to the board late", (train[0], late), duration=3.0, rate=20.0),
        Scenario("delays", "delays that change and stay", (train[0], delays, latest), duration=7.5, rate=20.0),
        Scenario(
            "early",
            "the destination was published before your node started",
            (known, train[1]),
            duration=2.0,
            rate=20.0,
        ),
        Scenario(
            "delay_first",
            "a delay before there is a destination",
            (at(0.3).publish("/delay", data=9), trains),
            rate=20.0,
        ),
    )
