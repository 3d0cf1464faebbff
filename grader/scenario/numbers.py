"""Streams of messages that each carry a number, of any message type, and what can go wrong with them.

`numbers` makes a stream; every fault takes a stream and returns another, so a scenario reads like a description:
`lost(numbers("/distance", wave(2.0, every(0.1, 5))), one_in=4, seed=1)`. A stream is a tuple of messages, which is what
`Scenario` takes. Instants come from `times`; `joint_states` has streams of joints.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from grader.recording.events import Fields
from grader.scenario.scenario import Message
from grader.scenario.times import SECOND, START, later

Stream = tuple[Message, ...]


def numbers(
    topic: str,
    values: Iterable[tuple[float, float]],
    type: str = "",
    field: str = "data",
    stamped: bool = False,
    **others: Any,
) -> Stream:
    """Return a message for each of `values`: pairs of an instant (s after the start) and a number.

    The number goes into `field`, which may be nested, such as `linear.x` of a Twist. With `stamped` each message
    has the instant in its `header.stamp`. `others` are fields that are the same in each message, such as
    `header={"frame_id": "base"}`. Without a `type` it is the one that exercise.toml declares for the topic.
    """
    stream = []
    for t, value in values:
        at = START + round(t * SECOND)
        fields: Fields = dict(others)
        if stamped:
            fields = with_stamp(fields, at)
        stream.append(Message(at, topic, type, _set(fields, field, value)))
    return tuple(stream)


def wave(height: float, times: Iterable[float], period: float = 2 * math.pi) -> list[tuple[float, float]]:
    """Return values of a sine that swings between `-height` and `height` once in `period` s."""
    return [(t, height * math.sin(2 * math.pi * t / period)) for t in times]


def chosen(lowest: float, highest: float, times: Iterable[float], seed: int) -> list[tuple[float, float]]:
    """Return random values between `lowest` and `highest`, the same for each `seed`."""
    chance = random.Random(f"chosen {lowest} {highest} {seed}")
    return [(t, chance.uniform(lowest, highest)) for t in times]


def placed(stream: Stream, number: int, value: float, field: str = "data") -> Stream:
    """Set the `field` that `numbers` filled to this value, such as `math.nan`, in message `number`, counted from 0.

    Raises `ValueError` if the message has no such field.
    """
    if not _has(stream[number].fields, field):
        found = f"message {number} on {stream[number].topic} has no number in its field {field!r}."
        raise ValueError(f"{found} Name the field as in numbers(), such as placed(…, field='range').")
    return changed(stream, [number], lambda message: replace(message, fields=_set(message.fields, field, value)))


def lost(stream: Stream, one_in: int, seed: int) -> Stream:
    """Lose about one in `one_in` messages, never the first or the last."""
    chance = random.Random(f"lost {seed}")
    last = len(stream) - 1
    return tuple(message for i, message in enumerate(stream) if i in (0, last) or chance.randrange(one_in))


def late(stream: Stream, most: float, seed: int) -> Stream:
    """Delay each message by up to `most` s without changing the order; stamps stay as they are."""
    instants = later([message.at for message in stream], most, seed)
    return tuple(replace(message, at=at) for message, at in zip(stream, instants, strict=True))


def twice(stream: Stream, number: int) -> Stream:
    """Publish message `number` twice at the same instant."""
    return (*stream[: number + 1], *stream[number:])


def paused(stream: Stream, before: int, seconds: float) -> Stream:
    """Publish nothing for `seconds` before message `before`; stamps, if any, move along."""
    wait = round(seconds * SECOND)
    return changed(stream, range(before, len(stream)), lambda message: _later(message, wait))


def restarted(stream: Stream, after: int) -> Stream:
    """Replace the publisher after message `after` by another one."""
    return changed(stream, range(after + 1, len(stream)), lambda message: replace(message, publisher=2))


def together(*streams: Stream) -> Stream:
    """Merge several streams, such as those of two topics, in the order of their instants."""
    return tuple(sorted((message for stream in streams for message in stream), key=lambda message: message.at))


def changed(stream: Stream, numbers: Iterable[int], change: Callable[[Message], Message]) -> Stream:
    """Return `stream` with `change` applied to the messages with these `numbers`, counted from 0."""
    chosen = set(numbers)
    return tuple(change(message) if i in chosen else message for i, message in enumerate(stream))


def with_stamp(fields: Fields, at: int) -> Fields:
    """Return a copy of `fields` with this stamp (ns) in the header."""
    return _set(fields, "header.stamp", {"sec": at // SECOND, "nanosec": at % SECOND})


def stamp_of(message: Message) -> int:
    """Return the stamp (ns) in a message's header."""
    stamp = message.fields["header"]["stamp"]
    return int(stamp["sec"]) * SECOND + int(stamp["nanosec"])


def _later(message: Message, wait: int) -> Message:
    stamped = "header" in message.fields
    fields = with_stamp(message.fields, stamp_of(message) + wait) if stamped else message.fields
    return replace(message, at=message.at + wait, fields=fields)


def _has(fields: Fields, path: str) -> bool:
    name, _, rest = path.partition(".")
    return name in fields and (not rest or _has(fields[name], rest))


def _set(fields: Fields, path: str, value: Any) -> Fields:
    """Return a copy of `fields` in which `path` has this value."""
    name, _, rest = path.partition(".")
    return {**fields, name: _set(fields.get(name, {}), rest, value) if rest else value}
