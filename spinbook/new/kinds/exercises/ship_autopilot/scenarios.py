"""What an autopilot is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from grader.scenario import Scenario, World, at
from grader.scenario.numbers import numbers
from grader.scenario.times import every


class Ship:
    """A ship that turns with half of its rudder's angle per second, half a second after the rudder (Nomoto, 1957).

    It also publishes how far it has turned (rad), which is for the checks: it never jumps, as a heading does at π.
    """

    reads: ClassVar = {"/rudder": "std_msgs/msg/Float64"}
    publishes: ClassVar = {"/heading": "std_msgs/msg/Float64", "/turned": "std_msgs/msg/Float64"}

    def __init__(self, heading: float) -> None:
        self.heading, self.turned, self.rate, self.rudder = heading, 0.0, 0.0, 0.0

    def hear(self, topic: str, message: Any) -> None:
        self.rudder = max(-0.6, min(0.6, message.data))

    def step(self, dt: float) -> None:
        self.rate += (0.5 * self.rudder - self.rate) * dt / 0.5
        self.turned += self.rate * dt

    def state(self) -> dict[str, dict[str, Any]]:
        heading = math.remainder(self.heading + self.turned, 2 * math.pi)
        return {"/heading": {"data": heading}, "/turned": {"data": self.turned}}


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""

    def voyage(name: str, title: str, heading: float, *courses: float, seconds: float = 15.0) -> Scenario:
        steps = tuple(at(1.05 + seconds * i).publish("/course", data=course) for i, course in enumerate(courses))
        duration = 1.05 + seconds * max(1, len(courses))
        ship = World(Ship, heading=heading, period=0.1)
        return Scenario(name, title, steps, world=ship, duration=duration, rate=20.0)

    # As fast as the ship can turn: a controller that also takes the turn rate into account is right, too.
    turning = [(time, 1.1 - 0.3 * time) for time in every(0.1, 4.0)]
    bench = (numbers("/heading", turning), at(1.05).publish("/course", data=0.5))
    return (
        Scenario("bench", "headings from a table: there is no ship yet", bench, interrupt=True),
        voyage("left", "a course to the left", 0.0, 1.0),
        voyage("right", "a course to the right", 0.5, -0.5),
        voyage("across", "a course on the other side of π", 3.0, -3.0),
        voyage("about", "half a turn", 0.2, -2.9, seconds=22.0),
        voyage("beyond", "a course beyond 2 π", 0.0, 7.0),
        voyage("two_courses", "a second course", -1.0, 0.5, -1.5),
        voyage("adrift", "no course at all", 0.4),
    )
