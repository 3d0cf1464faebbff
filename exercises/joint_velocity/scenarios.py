"""What a velocity node is run against. Each scenario is a fixture, by its name, in checks.py and hidden_checks.py."""

from __future__ import annotations

import math

from grader.scenario import Scenario
from grader.scenario.joint_states import ARM_SWING as ARMS
from grader.scenario.joint_states import (
    arm_swing,
    emptied,
    framed,
    late,
    lost,
    moving,
    paused,
    placed,
    published,
    restarted,
    shortened,
    shuffled,
    stamped,
    stamps_moved,
    without,
)
from grader.scenario.times import every, uneven

#: Joints that move at one speed each (rad/s): whatever the stamps, that is their velocity.
STEADY = {"left_elbow": 0.25, "right_elbow": -1.5, "left_shoulder_pitch": 0.0}

#: Joints that keep turning (rad/s): when a publisher starts again from zero, they jump back by several turns.
TURNING = {"waist": 12.0, "neck": -4.0}

ELBOW = "left_elbow"


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    swing = arm_swing(2)
    steady, turning = (
        {joint: (lambda t, speed=speed: speed * t) for joint, speed in speeds.items()} for speeds in (STEADY, TURNING)
    )
    ragged = moving(ARMS, uneven(0.02, 0.4, 20, seed))
    # The last two come 2 ms apart: no gap is too short for a velocity.
    times = uneven(0.05, 0.5, 13, seed)
    times += (times[-1] + 0.002, times[-1] + 0.004)
    reframed = framed(ragged, 10, "torso")
    broken = placed(placed(swing, 6, ELBOW, math.nan), 12, "right_elbow", math.inf)
    broken = placed(broken, 15, "left_shoulder_roll", -math.inf)
    streams = {
        "chapter": ("the chapter's own publisher", arm_swing(10)),
        "irregular": ("messages at uneven times", ragged),
        "steady": ("joints at one speed each, at uneven times", moving(steady, times)),
        "irregular_again": ("the same messages at uneven times, once more", ragged),
        "delayed": ("messages later than their stamps say; the frame changes", late(reframed, 0.3, seed)),
        "lossy": ("one in three messages is lost", lost(arm_swing(3), 3, seed)),
        "reordered": ("the joints in another order in each message", shuffled(swing, seed)),
        "new_joint": ("a joint that appears later", without(swing, ELBOW, 0, 8)),
        "missing_joint": ("a joint that goes away and comes back", without(swing, ELBOW, 7, 11)),
        "repeated_stamp": ("a stamp that is the same as the one before", stamped(swing, 9, like=8)),
        "backward_stamp": ("stamps that go back", stamps_moved(swing, 8, by=-50.03)),
        "gap": ("nothing comes for 30 s", paused(swing, 10, 30.0)),
        "not_finite": ("a position that is not a number, and two that are infinite", broken),
        "empty": ("a message without joints", emptied(swing, 9)),
        "short": ("a message with fewer positions than names", shortened(swing, 9, positions=4)),
        "burst": ("200 messages in 0.2 s", moving(ARMS, every(0.001, 0.2))),
        "restarted": (
            "another publisher takes over and starts from zero",
            restarted(moving({**ARMS, **turning}, every(0.1, 2.0)), after=10),
        ),
    }
    return tuple(
        Scenario(
            name,
            title,
            published(stream),
            interrupt=name == "chapter",
            # A node that measures with the computer's clock measures something else the second time.
            computer_time="simulated" if name == "irregular_again" else "apart",
        )
        for name, (title, stream) in streams.items()
    )
