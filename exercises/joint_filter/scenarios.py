"""Positions that tremble, and gains. Each scenario is a fixture in checks.py and hidden_checks.py."""

from __future__ import annotations

import math
import random

from grader.scenario import Scenario, at
from grader.scenario.joint_states import arm_swing, emptied, framed, late, published, shuffled, without
from grader.scenario.scenario import Content

#: The last joint of each message, and the parameter.
ELBOW, GAIN = "right_elbow", "gain"


def gain(value: object, *seconds: float) -> tuple[Content, ...]:
    """Somebody sets the gain."""
    return at(*seconds).set_parameter(GAIN, value)


def read(*seconds: float) -> tuple[Content, ...]:
    """Somebody reads the gain."""
    return at(*seconds).get_parameter(GAIN)


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    swing = arm_swing(2)
    stream = published(swing)
    drawn = round(random.Random(seed).uniform(0.15, 0.45), 3)
    refused = tuple(
        (gain(value, 0.45 + n / 5), read(0.5 + n / 5)) for n, value in enumerate((0.0, -0.2, 1.01, math.nan))
    )
    types = tuple((gain(value, 0.45 + n / 5), read(0.5 + n / 5)) for n, value in enumerate((1, "0.3", True)))
    scripts = {
        "default": ("the chapter's own publisher", (stream, read(1.95)), {}),
        "started": (f"started with a gain of {drawn}", (stream, read(1.95)), {GAIN: drawn}),
        "all_of_it": ("started with a gain of 1.0", (stream, read(1.95)), {GAIN: 1.0}),
        "changed": ("the gain changes twice", (stream, gain(0.1, 0.65), read(0.75), gain(0.9, 1.25), read(1.95)), {}),
        "refused": ("gains that are not allowed", (stream, *refused), {}),
        "other_types": ("gains of another type", (stream, *types), {}),
        "after_refusal": (
            "a gain that is not allowed, then two that are",
            (stream, gain(2.0, 0.65), gain(1.0, 1.05), gain(0.01, 1.55), read(1.95)),
            {},
        ),
        "reordered": ("the joints in another order in each message", (published(shuffled(swing, seed)),), {}),
        "missing_joint": ("a joint that goes away and comes back", (published(without(swing, ELBOW, 7, 11)),), {}),
        "empty": ("two messages without joints", (published(emptied(emptied(swing, 9), 10)),), {}),
        "delayed": (
            "messages later than their stamps say; the frame changes",
            (published(late(framed(swing, 10, "torso"), 0.3, seed)),),
            {},
        ),
        "new_joint": ("a joint that appears later", (published(without(swing, ELBOW, 0, 8)),), {}),
    }
    return tuple(
        Scenario(name, title, script, rate=20.0, duration=2.3, parameters=parameters, interrupt=name == "default")
        for name, (title, script, parameters) in scripts.items()
    )
