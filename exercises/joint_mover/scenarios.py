"""Goals for the joint. Each scenario is a fixture in checks.py and hidden_checks.py."""

from __future__ import annotations

import math

from grader.scenario import Scenario, at
from grader.scenario.scenario import Content

ACTION = "/move_joint"


def goal(position: float, *seconds: float) -> tuple[Content, ...]:
    """A goal is sent. Positions that are not a multiple of a step end with a shorter one, however they are rounded."""
    return at(*seconds).send_goal(ACTION, position=position)


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    up = goal(0.43, 0.5)
    scripts = {
        "up": ("a goal of 0.43 rad", 2.5, up),
        "down": ("up to 0.43 rad, then down to 0.1297 rad", 3.5, (up, goal(0.1297, 2.0))),
        "there": ("a goal where the joint is already", 1.5, (goal(0.0, 0.5),)),
        "limits": ("goals at both limits", 7.5, (goal(2.356, 0.5), goal(0.0, 6.0), at(6.8).cancel(2))),
        "out_of_reach": ("goals beyond the limits", 2.0, (goal(-0.01, 0.5), goal(2.36, 0.7), goal(0.11, 0.9))),
        "not_a_number": (
            "a goal that is not a number",
            2.0,
            (goal(math.nan, 0.5), goal(math.inf, 0.7), goal(0.11, 0.9)),
        ),
        "canceled": ("a goal, canceled after 0.55 s", 2.5, (goal(0.83, 0.5), at(1.05).cancel(1))),
        "after_cancel": (
            "another goal after one was canceled",
            3.0,
            (goal(0.83, 0.5), at(1.05).cancel(1), goal(0.11, 1.5)),
        ),
        "replaced": ("a second goal while the first one runs", 3.0, (goal(0.83, 0.5), goal(0.11, 1.05))),
        "replaced_upwards": ("a farther goal while the first one runs", 3.5, (goal(0.43, 0.5), goal(0.83, 1.05))),
        "rejected_meanwhile": ("a goal beyond the limits while one runs", 2.5, (up, goal(3.0, 0.85))),
    }
    return tuple(
        Scenario(name, title, script, duration=duration, rate=20.0, interrupt=name == "up")
        for name, (title, duration, script) in scripts.items()
    )
