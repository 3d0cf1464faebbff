"""What an observer is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import ActionServer, Scenario, aborts, at, never_ends, rejects, succeeds


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    turned = succeeds(after=1.0, result={"delta": 0.5})
    one = at(0.3).publish("/star", data=0.5)
    refuses = succeeds(after=2.0, cancel="refuse")
    three = (one, at(0.4).publish("/star", data=-1.25), at(0.9).publish("/star", data=0.75))
    clouds = at(2.1).publish("/clouds")
    gap = (one, clouds, at(3.0).publish("/star", data=1.0))

    def scenario(name: str, title: str, steps: object, *goals: object, **more: object) -> Scenario:
        return Scenario(
            name, title, steps, servers=(ActionServer("/turn", goals=goals, **more),), duration=8.0, rate=20.0
        )

    return (
        Scenario(
            "one_star",
            "one star",
            one,
            servers=(ActionServer("/turn", goals=turned),),
            duration=3.0,
            interrupt=True,
            rate=20.0,
        ),
        scenario("three_stars", "three stars in quick succession", three, turned),
        scenario("rejected", "the telescope rejects the first star", three, rejects(), turned),
        scenario("aborted", "the telescope gives up on the second star", three, turned, aborts(after=0.5), turned),
        scenario("cloudy", "clouds come up while the telescope turns", (three, clouds), turned, never_ends(), turned),
        scenario(
            "stubborn",
            "the telescope refuses to cancel",
            (three, clouds),
            turned,
            refuses,
            turned,
        ),
        scenario("idle_clouds", "clouds while no goal is served", gap, turned),
        scenario("late", "the telescope appears after 2.1 s", three, turned, appears=2.1),
        scenario("slow", "the telescope accepts goals late", three, succeeds(after=1.5, answers_after=0.7)),
    )
