"""Streams of JointState messages, and what can go wrong with them.

`arm_swing` makes a stream; every fault, here or in `numbers`, takes a stream and returns another, so a scenario reads
like a description: `lost(arm_swing(3), one_in=4, seed=1)`.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from grader.scenario.numbers import Stream, changed, stamp_of, with_stamp
from grader.scenario.numbers import late as late
from grader.scenario.numbers import lost as lost
from grader.scenario.numbers import paused as paused
from grader.scenario.scenario import Message
from grader.scenario.times import SECOND, START, every

#: A humanoid's six arm joints and their positions (rad) `t` seconds after the start.
ARM_SWING: dict[str, Callable[[float], float]] = {
    "left_shoulder_pitch": lambda t: 0.5 * math.sin(t),
    "left_shoulder_roll": lambda t: 0.3 * math.cos(t),
    "left_elbow": lambda t: 0.8 * math.sin(2 * t),
    "right_shoulder_pitch": lambda t: -0.5 * math.sin(t),
    "right_shoulder_roll": lambda t: -0.3 * math.cos(t),
    "right_elbow": lambda t: -0.8 * math.sin(2 * t),
}


def moving(joints: dict[str, Callable[[float], float]], times: Iterable[float], frame_id: str = "base_link") -> Stream:
    """Return a stream in which each joint follows its function, at each of `times` (s after the start).

    The velocities are 0.
    """
    stream = []
    for t in times:
        at = START + round(t * SECOND)
        positions, velocities = [where(t) for where in joints.values()], [0.0] * len(joints)
        fields = {"header": {"frame_id": frame_id}, "name": list(joints), "position": positions, "velocity": velocities}
        stream.append(Message(at, "/joint_commands", "sensor_msgs/msg/JointState", with_stamp(fields, at)))
    return tuple(stream)


def arm_swing(seconds: float, period: float = 0.1) -> Stream:
    """Return the stream of two swinging arms, with a message every `period` seconds."""
    return moving(ARM_SWING, every(period, seconds))


def shuffled(stream: Stream, seed: int) -> Stream:
    """Shuffle the order of the joints in each message."""
    chance = random.Random(f"shuffled {seed}")
    result = []
    for message in stream:
        order = list(range(len(message.fields["name"])))
        chance.shuffle(order)
        result.append(_pick(message, order))
    return tuple(result)


def without(stream: Stream, joint: str, first: int, last: int) -> Stream:
    """Remove `joint` from messages `first` to `last`, counted from 0."""

    def drop(message: Message) -> Message:
        return _pick(message, [i for i, name in enumerate(message.fields["name"]) if name != joint])

    return changed(stream, range(first, last + 1), drop)


def stamped(stream: Stream, number: int, like: int) -> Stream:
    """Give message `number` the stamp of message `like`."""
    stamp = stamp_of(stream[like])
    return changed(stream, [number], lambda message: replace(message, fields=with_stamp(message.fields, stamp)))


def stamps_moved(stream: Stream, first: int, by: float) -> Stream:
    """Move every stamp from message `first` on by `by` s; a negative `by` makes them earlier."""

    def move(message: Message) -> Message:
        return replace(message, fields=with_stamp(message.fields, stamp_of(message) + round(by * SECOND)))

    return changed(stream, range(first, len(stream)), move)


def placed(stream: Stream, number: int, joint: str, position: float) -> Stream:
    """Give `joint` this position, such as `math.nan`, in message `number`."""
    positions = list(stream[number].fields["position"])
    positions[stream[number].fields["name"].index(joint)] = position
    return changed(stream, [number], lambda message: _with(message, position=positions))


def emptied(stream: Stream, number: int) -> Stream:
    """Remove all joints from message `number`."""
    return changed(stream, [number], lambda message: _pick(message, []))


def shortened(stream: Stream, number: int, positions: int) -> Stream:
    """Keep only this many `positions` in message `number`, but all names."""
    return changed(stream, [number], lambda message: _with(message, position=message.fields["position"][:positions]))


def framed(stream: Stream, first: int, frame_id: str) -> Stream:
    """Set the frame to `frame_id` from message `first` on."""

    def frame(message: Message) -> Message:
        return _with(message, header={**message.fields["header"], "frame_id": frame_id})

    return changed(stream, range(first, len(stream)), frame)


def restarted(stream: Stream, after: int) -> Stream:
    """Replace the publisher after message `after`; the new one starts the same movement from its beginning."""
    rest = [
        replace(_with(message, name=again.fields["name"], position=again.fields["position"]), publisher=2)
        for message, again in zip(stream[after + 1 :], stream, strict=False)
    ]
    return (*stream[: after + 1], *rest)


def published(stream: Stream, topic: str = "/joint_commands") -> Stream:
    """Return the stream as messages on `topic`."""
    return tuple(replace(message, topic=topic) for message in stream)


def _with(message: Message, **fields: Any) -> Message:
    return replace(message, fields={**message.fields, **fields})


def _pick(message: Message, order: list[int]) -> Message:
    parts = ("name", "position", "velocity")
    return _with(message, **{part: [message.fields[part][i] for i in order] for part in parts})
