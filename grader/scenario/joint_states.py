"""Streams of JointState messages, and what can go wrong with them.

A stream is a tuple of `Sample`s. `arm_swing` makes one; every fault takes a stream and returns another, so that a
scenario reads as what happens: `lost(arm_swing(3), one_in=4, seed=1)`.
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
    """A stream in which each joint is where its function puts it at each of `times` (s after the start)."""
    stream = []
    for t in times:
        at = START + round(t * SECOND)
        stream.append(Sample(at, at, tuple(joints), tuple(where(t) for where in joints.values()), frame_id))
    return tuple(stream)


def arm_swing(seconds: float, period: float = 0.1) -> Stream:
    """Return the stream of two arms that swing, a message every `period` seconds."""
    return moving(ARM_SWING, every(period, seconds))


def lost(stream: Stream, one_in: int, seed: int) -> Stream:
    """About one in `one_in` messages is lost, never the first or the last."""
    chance = random.Random(f"lost {seed}")
    return tuple(s for s in stream if s in (stream[0], stream[-1]) or chance.randrange(one_in))


def shuffled(stream: Stream, seed: int) -> Stream:
    """The joints are in another order in each message."""
    chance = random.Random(f"shuffled {seed}")
    result = []
    for sample in stream:
        order = list(range(len(sample.names)))
        chance.shuffle(order)
        result.append(_pick(sample, order))
    return tuple(result)


def late(stream: Stream, most: float, seed: int) -> Stream:
    """Each message comes up to `most` s later than its stamp says, none before the one that was stamped earlier."""
    instants = later([sample.at for sample in stream], most, seed)
    return tuple(replace(sample, at=at) for sample, at in zip(stream, instants, strict=True))


def without(stream: Stream, joint: str, first: int, last: int) -> Stream:
    """`joint` is missing from message number `first` to number `last`, counted from 0."""

    def drop(sample: Sample) -> Sample:
        return _pick(sample, [i for i, name in enumerate(sample.names) if name != joint])

    return changed(stream, range(first, last + 1), drop)


def stamped(stream: Stream, number: int, like: int) -> Stream:
    """Message `number` has the stamp of message `like`."""
    return changed(stream, [number], lambda sample: replace(sample, stamp=stream[like].stamp))


def stamps_moved(stream: Stream, first: int, by: float) -> Stream:
    """From message `first` on, every stamp is `by` s later, or earlier where `by` is negative."""
    return changed(
        stream, range(first, len(stream)), lambda sample: replace(sample, stamp=sample.stamp + round(by * SECOND))
    )


def paused(stream: Stream, before: int, seconds: float) -> Stream:
    """Nothing is published for `seconds` before message number `before`; the joints stay where they are."""
    wait = round(seconds * SECOND)
    return changed(
        stream,
        range(before, len(stream)),
        lambda sample: replace(sample, at=sample.at + wait, stamp=sample.stamp + wait),
    )


def placed(stream: Stream, number: int, joint: str, position: float) -> Stream:
    """In message `number`, `joint` has this position, such as `math.nan`."""

    def place(sample: Sample) -> Sample:
        positions = list(sample.positions)
        positions[sample.names.index(joint)] = position
        return replace(sample, positions=tuple(positions))

    return changed(stream, [number], place)


def emptied(stream: Stream, number: int) -> Stream:
    """Message `number` names no joint."""
    return changed(stream, [number], lambda sample: replace(sample, names=(), positions=()))


def shortened(stream: Stream, number: int, positions: int) -> Stream:
    """Message `number` has only this many `positions`, for all its names."""
    return changed(stream, [number], lambda sample: replace(sample, positions=sample.positions[:positions]))


def framed(stream: Stream, first: int, frame_id: str) -> Stream:
    """From message `first` on, the frame is `frame_id`."""
    return changed(stream, range(first, len(stream)), lambda sample: replace(sample, frame_id=frame_id))


def restarted(stream: Stream, after: int) -> Stream:
    """After message `after` the publisher disappears; a new one starts the same movement from its beginning."""
    rest = [
        replace(sample, names=again.names, positions=again.positions, publisher=2)
        for sample, again in zip(stream[after + 1 :], stream, strict=False)
    ]
    return (*stream[: after + 1], *rest)


def changed(stream: Stream, numbers: Iterable[int], change: Callable[[Sample], Sample]) -> Stream:
    """`stream` with `change` made to the messages of these `numbers`, counted from 0."""
    wanted = set(numbers)
    return tuple(change(sample) if i in wanted else sample for i, sample in enumerate(stream))


def published(stream: Stream, topic: str = "/joint_commands") -> tuple[Message, ...]:
    """The stream as messages on `topic`, with a velocity of 0 for each joint."""
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
