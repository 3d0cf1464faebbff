"""What a fire watch is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario, Server, at, no_reply, reply


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    works, refuses = reply(success=True), reply(success=False, message="no water")
    fire = (at(0.5).publish("/smoke", data=0.1), at(1.1, 1.5, 1.9).publish("/smoke", data=0.8))
    over = at(3.1, 3.5).publish("/smoke", data=0.2)
    edges = tuple(at(0.5 + 0.5 * i).publish("/smoke", data=value) for i, value in enumerate((0.3, 0.31, 0.3, 0.0, 1.0)))

    def scenario(name: str, title: str, steps: object, *replies: object, **more: object) -> Scenario:
        return Scenario(
            name, title, steps, servers=(Server("/sprinkler", replies=replies, **more),), duration=6.0, rate=20.0
        )

    return (
        Scenario(
            "fire",
            "a fire begins and ends",
            (fire, over),
            servers=(Server("/sprinkler", replies=works),),
            duration=5.0,
            interrupt=True,
            rate=20.0,
        ),
        scenario("edges", "smoke at the edge of a fire", edges, works),
        scenario("refused", "the sprinkler refuses, then works", (fire, over), refuses, works),
        scenario("slow", "the sprinkler answers after 1.5 s", (fire, over), reply(1.5, success=True)),
        scenario("overtaken", "the fire ends before the sprinkler answers", (fire, over), reply(2.5, success=True)),
        scenario("silent", "the sprinkler never answers", (fire, over), no_reply()),
        scenario("late", "the sprinkler appears after 2.5 s", (fire, over), works, appears=2.5),
        scenario("too_late", "the sprinkler appears when the fire is over", (fire, over), works, appears=4.5),
    )
