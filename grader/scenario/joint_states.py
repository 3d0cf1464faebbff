"""Streams of JointState messages, and what can go wrong with them.

A stream is a tuple of `Sample`s. `arm_swing` makes one; every fault takes a stream and returns another, so a
scenario reads like a description: `lost(arm_swing(3), one_in=4, seed=1)`.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from grader.scenario.scenario import Message
from grader.scenario.times import SECOND, START, every, later

#: A humanoid's six arm joints and their positions (rad) `t` seconds after the start.
ARM_SWING: dict[str, Callable[[float], float]] = {
    "left_shoulder_pitch": lambda t: 0.5 * math.sin(t),
    "left_shoulder_roll": lambda t: 0.3 * math.cos(t),
    "left_elbow": lambda t: 0.8 * math.sin(2 * t),
    "right_shoulder_pitch": lambda t: -0.5 * math.sin(t),
    "right_shoulder_roll": lambda t: -0.3 * math.cos(t),
    "right_elbow": lambda t: -0.8 * math.sin(2 * t),
}


@dataclass(frozen=True)
class Sample:
    """One JointState: published at `at` ns, stamped `stamp` ns, positions in rad.

    There may be fewer `positions` than `names`.
    """

    at: int
    stamp: int
    names: tuple[str, ...]
    positions: tuple[float, ...]
    frame_id: str = "base_link"
    publisher: int = 1


Stream = tuple[Sample, ...]


def moving(joints: dict[str, Callable[[float], float]], times: Iterable[float], frame_id: str = "base_link") -> Stream:
    """Return a stream in which each joint follows its function, at each of `times` (s after the start)."""
    stream = []
    for t in times:
        at = START + round(t * SECOND)
        stream.append(Sample(at, at, tuple(joints), tuple(where(t) for where in joints.values()), frame_id))
    return tuple(stream)


def arm_swing(seconds: float, period: float = 0.1) -> Stream:
    """Return the stream of two swinging arms, with a message every `period` seconds."""
    return moving(ARM_SWING, every(period, seconds))


def lost(stream: Stream, one_in: int, seed: int) -> Stream:
    """Lose about one in `one_in` messages, never the first or the last."""
    chance = random.Random(f"lost {seed}")
    return tuple(s for s in stream if s in (stream[0], stream[-1]) or chance.randrange(one_in))


def shuffled(stream: Stream, seed: int) -> Stream:
    """Shuffle the order of the joints in each message."""
    chance = random.Random(f"shuffled {seed}")
    result = []
    for sample in stream:
        order = list(range(len(sample.names)))
        chance.shuffle(order)
        result.append(_pick(sample, order))
    return tuple(result)


def late(stream: Stream, most: float, seed: int) -> Stream:
    """Delay each message by up to `most` s after its stamp, without changing the order."""
    instants = later([sample.at for sample in stream], most, seed)
    return tuple(replace(sample, at=at) for sample, at in zip(stream, instants, strict=True))


def without(stream: Stream, joint: str, first: int, last: int) -> Stream:
    """Remove `joint` from messages `first` to `last`, counted from 0."""

    def drop(sample: Sample) -> Sample:
        return _pick(sample, [i for i, name in enumerate(sample.names) if name != joint])

    return changed(stream, range(first, last + 1), drop)


def stamped(stream: Stream, number: int, like: int) -> Stream:
    """Give message `number` the stamp of message `like`."""
    return changed(stream, [number], lambda sample: replace(sample, stamp=stream[like].stamp))


def stamps_moved(stream: Stream, first: int, by: float) -> Stream:
    """Move every stamp from message `first` on by `by` s; a negative `by` makes them earlier."""
    return changed(
        stream, range(first, len(stream)), lambda sample: replace(sample, stamp=sample.stamp + round(by * SECOND))
    )


def paused(stream: Stream, before: int, seconds: float) -> Stream:
    """Publish nothing for `seconds` before message `before`; the joints stay where they are."""
    wait = round(seconds * SECOND)
    return changed(
        stream,
        range(before, len(stream)),
        lambda sample: replace(sample, at=sample.at + wait, stamp=sample.stamp + wait),
    )


def placed(stream: Stream, number: int, joint: str, position: float) -> Stream:
    """Give `joint` this position, such as `math.nan`, in message `number`."""

    def place(sample: Sample) -> Sample:
        positions = list(sample.positions)
        positions[sample.names.index(joint)] = position
        return replace(sample, positions=tuple(positions))

    return changed(stream, [number], place)


def emptied(stream: Stream, number: int) -> Stream:
    """Remove all joints from message `number`."""
    return changed(stream, [number], lambda sample: replace(sample, names=(), positions=()))


def shortened(stream: Stream, number: int, positions: int) -> Stream:
    """Keep only this many `positions` in message `number`, but all names."""
    return changed(stream, [number], lambda sample: replace(sample, positions=sample.positions[:positions]))


def framed(stream: Stream, first: int, frame_id: str) -> Stream:
    """Set the frame to `frame_id` from message `first` on."""
    return changed(stream, range(first, len(stream)), lambda sample: replace(sample, frame_id=frame_id))


def restarted(stream: Stream, after: int) -> Stream:
    """Replace the publisher after message `after`; the new one starts the same movement from its beginning."""
    rest = [
        replace(sample, names=again.names, positions=again.positions, publisher=2)
        for sample, again in zip(stream[after + 1 :], stream, strict=False)
    ]
    return (*stream[: after + 1], *rest)


def changed(stream: Stream, numbers: Iterable[int], change: Callable[[Sample], Sample]) -> Stream:
    """Return `stream` with `change` applied to the messages with these `numbers`, counted from 0."""
    chosen = set(numbers)
    return tuple(change(sample) if i in chosen else sample for i, sample in enumerate(stream))


def published(stream: Stream, topic: str = "/joint_commands") -> tuple[Message, ...]:
    """Return the stream as messages on `topic`, with a velocity of 0 for each joint."""
    return tuple(
        Message(
            at=sample.at,
            topic=topic,
            type="sensor_msgs/msg/JointState",
            fields={
                "header": {
                    "stamp": {"sec": sample.stamp // SECOND, "nanosec": sample.stamp % SECOND},
                    "frame_id": sample.frame_id,
                },
                "name": list(sample.names),
                "position": list(sample.positions),
                "velocity": [0.0] * len(sample.names),
            },
            publisher=sample.publisher,
        )
        for sample in stream
    )


def _pick(sample: Sample, order: list[int]) -> Sample:
    return replace(
        sample, names=tuple(sample.names[i] for i in order), positions=tuple(sample.positions[i] for i in order)
    )
