"""What a turnstile is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario, at


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    visitors = (
        at(0.5, 1.0).publish("/coins", data=50),
        at(1.5, 2.0).call("/push"),
        at(2.5).publish("/coins", data=20),
        at(3.0).call("/push"),
    )
    change = (at(0.5).publish("/coins", data=200), at(0.6).publish("/coins", data=50), at(1.0, 1.5, 2.0).call("/push"))
    all_coins = tuple(at(0.5 + i).publish("/coins", data=coin) for i, coin in enumerate((10, 20, 50, 100, 200)))
    pushes = at(1.0, 2.0, 3.0, 4.0, 5.0, 5.2, 5.4, 5.6).call("/push")
    not_coins = tuple(at(0.5 + i).publish("/coins", data=value) for i, value in enumerate((30, 0, -100, 5, 1000)))
    crowd = (at(0.5, 0.6).publish("/coins", data=200), at(1.0, 1.0, 1.0, 1.0, 1.0).call("/push"))
    return (
        Scenario("visitors", "two visitors, one of them with too little", visitors, interrupt=True, rate=20.0),
        Scenario("change", "more coins than one visit costs", change, rate=20.0),
        Scenario("all_coins", "each coin there is, with pushes between", (all_coins, pushes), rate=20.0),
        Scenario(
            "not_coins", "values that are not coins", (not_coins, at(1.0, 2.0, 3.0, 4.0, 5.0).call("/push")), rate=20.0
        ),
        Scenario("crowd", "five pushes at one moment", crowd, rate=20.0),
    )
