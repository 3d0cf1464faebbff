"""A run: one scenario as a check sees it, with the messages sent, the messages received, and the solution's answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NoReturn

from grader.checking.actions import ActionChecks
from grader.checking.graph import GraphChecks
from grader.checking.matching import AT_ONCE
from grader.checking.parameters import ParameterChecks
from grader.checking.series import SeriesChecks
from grader.checking.services import ServiceChecks
from grader.checking.trajectory import TrajectoryChecks
from grader.checking.verdict import Finding, Wrong
from grader.recording.recording import EndPoint, Received, Recording, Sent
from grader.scenario.times import SECOND, START

#: The topic on which the grader publishes simulated time. Every program that uses simulated time subscribes to it.
CLOCK = "/clock"


class Part:
    """Some fields of a message, by name: `message.header.frame_id`."""

    def __init__(self, fields: dict[str, Any]) -> None:
        self._fields = fields

    def __getattr__(self, name: str) -> Any:
        try:
            value = self._fields[name]
        except KeyError:
            raise AttributeError(f"a message of this type has no field {name!r}") from None
        return Part(value) if isinstance(value, dict) else value

    def __repr__(self) -> str:
        return f"Message({self._fields})"


class Message(Part):
    """A message that was sent or received: its fields by name, its `stamp` (s), its topic, and when it arrived (s). For
    a message sent, `heard` says whether the student's node subscribed to its topic at that moment. For a message
    received, `after` is the number of messages that had been sent by then. `at_ns` is its moment of simulated time in
    nanoseconds.
    """

    def __init__(self, kept: Sent | Received) -> None:
        super().__init__(kept.fields)
        self.heard = not isinstance(kept, Sent) or kept.heard
        self.at = (kept.at - START) / SECOND
        self.at_ns = kept.at
        self.after = kept.after if isinstance(kept, Received) else 0
        self.topic = kept.topic

    @property
    def stamp(self) -> float:
        """The header's stamp in seconds."""
        return self.stamp_ns / SECOND

    @property
    def stamp_ns(self) -> int:
        """The header's stamp in nanoseconds."""
        stamp = self._fields["header"]["stamp"]
        return int(stamp["sec"]) * SECOND + int(stamp["nanosec"])

    def value(self, field: str) -> Any:
        """A field by its full name, such as `header.frame_id`."""
        value: Any = self._fields
        for name in field.split("."):
            value = value[name]
        return value

    def by(self, key: str, field: str) -> dict[str, Any]:
        """Two lists as a dictionary: `by("name", "velocity")` gives each joint's velocity."""
        return dict(zip(self.value(key), self.value(field), strict=False))


@dataclass(frozen=True)
class Exchange:
    """One message sent, everything that the node answered to it, and what the solution answered.

    `number` counts the messages sent, from 1.
    """

    number: int
    sent: Message
    answers: tuple[Message, ...]
    expected: tuple[Message, ...]


class Run(SeriesChecks, ServiceChecks, ActionChecks, ParameterChecks, TrajectoryChecks, GraphChecks):
    """What happened in one scenario. Iterate over it to get each `Exchange`."""

    @cached_property
    def sent(self) -> list[Message]:
        """Every message sent to the node."""
        return [Message(sent) for sent in self.recording.sent]

    @cached_property
    def received(self) -> list[Message]:
        """Every message that the node published on the exercise's topics."""
        return [Message(received) for received in self.recording.received if not received.subscriber]

    @cached_property
    def exchanges(self) -> list[Exchange]:
        """Each message sent, with its answers."""
        answers = _answers(self.recording)
        expected = _answers(self._reference)
        return [
            Exchange(i + 1, sent, tuple(answers.get(i, ())), tuple(expected.get(i, ())))
            for i, sent in enumerate(self.sent)
        ]

    def __iter__(self) -> Iterator[Exchange]:
        return iter(self.exchanges)

    def on(self, topic: str) -> Run:
        """The same run with only the messages on `topic`, for a node that publishes on several topics."""
        mine, its = (
            replace(recording, received=tuple(one for one in recording.received if one.topic == topic))
            for recording in (self.recording, self._reference)
        )
        return Run(self.exercise, mine, its, self.title)

    def publishers(self, topic: str) -> list[EndPoint]:
        """The student's publishers on `topic`."""
        return [e for e in self.recording.end_points if e.kind == "publisher" and e.topic == topic]

    def subscriptions(self, topic: str) -> list[EndPoint]:
        """The student's subscriptions of `topic`."""
        return [e for e in self.recording.end_points if e.kind == "subscription" and e.topic == topic]

    def topics(self, kind: str) -> list[str]:
        """Names of all topics that the student's nodes publish (kind "publisher") or subscribe to ("subscription").

        A subscription to `/clock` is left out unless the exercise is about it: the grader makes rclpy have it.
        """
        ours = {CLOCK} - {topic.name for topic in self.exercise.topics} if kind == "subscription" else set()
        return sorted({e.topic for e in self.recording.end_points if e.kind == kind} - ours)

    def must_match(self, field: str, per: str = "", tolerance: float = 1e-6, missing_ok: bool = False) -> None:
        """If the solution answers a message, the node must answer it, with the same `field`.

        `per` names the list of names that `field` goes with, so that the order does not count: `must_match("velocity",
        per="name")`. Numbers may differ by `tolerance`, absolute or relative, whichever is larger. With `missing_ok`,
        missing answers are ignored, because another check judges them.
        """
        from grader.checking.matching import must_match

        must_match(self, field, per, tolerance, missing_ok)

    def must_answer(self) -> None:
        """The node must answer every message that the solution answers, once."""
        from grader.checking.matching import must_answer

        must_answer(self)

    def must_answer_at_once(self, within: float = AT_ONCE) -> None:
        """Each answer must come before the next message, and within this many seconds of simulated time. Missing
        answers are ignored, because another check judges them.
        """
        from grader.checking.matching import must_answer_at_once

        must_answer_at_once(self, within)

    def must_vary(self, field: str, per: str = "") -> None:
        """If the solution's `field` changes from message to message, the node's must change too.

        A node that publishes zeros or a constant fails, one with wrong values does not. `per` is as in `must_match`.
        """
        from grader.checking.matching import must_vary

        must_vary(self, field, per)

    def must_be_silent(self) -> None:
        """The node must not answer messages that the solution does not answer. The very first message does not
        count."""
        from grader.checking.matching import must_be_silent

        must_be_silent(self.exchanges[1:], self)

    def must_be_silent_at_first(self) -> None:
        """The node must not answer the very first message, if the solution does not."""
        from grader.checking.matching import must_be_silent

        must_be_silent(self.exchanges[:1], self)

    def wrong(self, exchange: Exchange, text: str, part: str = "", expected: object = "", got: object = "") -> NoReturn:
        """End the check: `text` says what is wrong with the answers to this exchange's message. `part` is the wrong
        part of the message, such as the joint; reports show `expected` and `got` separately.
        """
        where = f"Message {exchange.number} of {len(self.sent)} ({exchange.sent.at:.2f} s after the start"
        where += f"; {self.title})" if self.title else ")"
        message = f"{where}{f', {part}' if part else ''}: {text}"
        raise Wrong(Finding(message, self.scenario, exchange.number, exchange.sent.at, part, str(expected), str(got)))


def _answers(recording: Recording) -> dict[int, list[Message]]:
    """Index of a message sent -> what was received for it.

    A message is matched by its stamp if exactly one message sent has that stamp, otherwise by when it arrived.
    """
    index: dict[int, list[int]] = {}
    for i, sent in enumerate(recording.sent):
        index.setdefault(Message(sent).stamp_ns if "header" in sent.fields else -1, []).append(i)
    answers: dict[int, list[Message]] = {}
    for received in recording.received:
        if received.subscriber:
            continue
        message = Message(received)
        by_stamp = index.get(message.stamp_ns, []) if "header" in received.fields else []
        answers.setdefault(by_stamp[0] if len(by_stamp) == 1 else max(received.after - 1, 0), []).append(message)
    return answers
