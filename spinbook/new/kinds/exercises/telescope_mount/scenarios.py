"""What a telescope is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario, at


def goals(*times_and_angles: tuple[float, float]) -> tuple[object, ...]:
    """Goals for the telescope: each at its time (s), for its angle (rad)."""
    return tuple(at(seconds).send_goal("/point", theta=angle) for seconds, angle in times_and_angles)


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    return (
        Scenario("one_goal", "one goal, 0.35 rad away", goals((0.3, 0.35)), duration=4.0, interrupt=True, rate=20.0),
        Scenario(
            "in_turn",
            "three goals, one after another",
            goals((0.3, 0.25), (3.3, -0.2), (7.3, 0.1)),
            duration=10.0,
            rate=20.0,
        ),
        Scenario(
            "there", "a goal where the telescope is", goals((0.3, 0.0), (1.3, 0.1), (3.3, 0.1)), duration=5.0, rate=20.0
        ),
        Scenario(
            "edges", "goals as far as the telescope turns", goals((0.3, 1.5), (9.3, -1.5)), duration=26.0, rate=20.0
        ),
        Scenario(
            "too_far", "goals that are too far", goals((0.3, 1.6), (0.8, -1.6), (1.3, 0.2)), duration=4.0, rate=20.0
        ),
        Scenario(
            "busy",
            "a second goal while one is served",
            goals((0.3, 0.5), (1.5, 0.2), (4.3, 0.2)),
            duration=7.0,
            rate=20.0,
        ),
        Scenario("canceled", "a goal is canceled", (goals((0.3, 1.0)), at(1.6).cancel(1)), duration=4.0, rate=20.0),
        Scenario(
            "after_cancel",
            "the next goal after a cancel",
            (goals((0.3, 1.0), (3.3, 0.0)), at(1.6).cancel(1)),
            duration=6.0,
            rate=20.0,
        ),
    )
