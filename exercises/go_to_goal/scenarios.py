"""Where the turtle starts, and where it is sent. Each scenario is a fixture in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario, Turtle, World, at

GOAL = "/goal"


class CarriedTurtle(Turtle):
    """A turtle that is carried to the middle of its square, 11 s after the start."""

    seconds = 0.0

    def step(self, seconds: float) -> None:
        """Move on, by itself or in somebody's hand."""
        before, self.seconds = self.seconds, self.seconds + seconds
        super().step(seconds)
        if before < 11.0 <= self.seconds:
            self.x = self.y = 5.5


class PushedTurtle(Turtle):
    """A turtle that is pushed aside, and turned, 2.5 s after the start."""

    seconds = 0.0

    def step(self, seconds: float) -> None:
        """Move on, by itself or because somebody pushes it."""
        before, self.seconds = self.seconds, self.seconds + seconds
        super().step(seconds)
        if before < 2.5 <= self.seconds:
            self.y += 1.5
            self.theta -= 0.6


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    return (
        Scenario(
            "ahead",
            "a goal ahead, a little to the left",
            (at(0.5).publish(GOAL, x=8.5, y=7.0),),
            world=World(Turtle, period=0.016, x=4.0, y=5.5, theta=0.0),
            duration=11.0,
            rate=10.0,
            interrupt=True,
        ),
        Scenario(
            "no_goal",
            "no goal is published",
            world=World(Turtle, period=0.016, x=5.5, y=5.5, theta=1.0),
            duration=2.0,
            rate=10.0,
        ),
        Scenario(
            "short_way",
            "the shorter way to turn goes past 180 degrees; carried away at 11 s, and sent back at 12.5 s",
            (at(0.5, 12.5).publish(GOAL, x=3.0, y=4.0),),
            world=World(CarriedTurtle, period=0.016, x=8.0, y=5.5, theta=2.6),
            duration=22.6,
            rate=10.0,
        ),
        Scenario(
            "behind",
            "a goal behind the turtle, in a corner",
            (at(0.5).publish(GOAL, x=9.8, y=9.8),),
            world=World(Turtle, period=0.016, x=2.5, y=2.5, theta=-2.0),
            duration=11.0,
            rate=10.0,
        ),
        Scenario(
            "next_goal",
            "a second goal, after the first was reached",
            (at(0.5).publish(GOAL, x=6.2, y=6.2), at(4.0).publish(GOAL, x=3.0, y=6.0)),
            world=World(Turtle, period=0.016, x=5.5, y=5.5, theta=0.0),
            duration=14.5,
            rate=10.0,
        ),
        Scenario(
            "new_goal",
            "a second goal, while the turtle is on its way to the first",
            (at(0.5).publish(GOAL, x=10.0, y=5.5), at(2.0).publish(GOAL, x=3.0, y=3.0)),
            world=World(Turtle, period=0.016, x=1.0, y=5.5, theta=0.0),
            duration=12.5,
            rate=10.0,
        ),
        Scenario(
            "pushed",
            "the turtle is pushed aside on its way",
            (at(0.5).publish(GOAL, x=9.0, y=4.0),),
            world=World(PushedTurtle, period=0.016, x=2.0, y=3.0, theta=0.0),
            duration=11.0,
            rate=10.0,
        ),
    )
