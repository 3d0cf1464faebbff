"""Messages as a check sees them, and which messages answer which."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from grader.recording.events import Truth
from grader.recording.fields import Part
from grader.recording.recording import ReceivedMessage, Recording, SentMessage
from grader.scenario.times import SECOND, START
from ros_in_python.field_path import field_of


class Message(Part):
    """A message that was sent or received: its fields by name, its `stamp` (s), its topic, and when it arrived (s).

    For a sent message, `heard` says whether the student's node subscribed to its topic at that moment. For a received
    message, `after` is the number of messages that had been sent by then. `at_ns` is its simulated time in nanoseconds.
    """

    def __init__(self, kept: SentMessage | ReceivedMessage) -> None:
        super().__init__(kept.fields)
        self.heard = not isinstance(kept, SentMessage) or kept.heard
        self.at = (kept.at - START) / SECOND
        self.at_ns = kept.at
        self.after = kept.after if isinstance(kept, ReceivedMessage) else 0
        self.topic = kept.topic

    @property
    def stamp(self) -> float:
        """Return the header's stamp in seconds."""
        return self.stamp_ns / SECOND

    @property
    def stamp_ns(self) -> int:
        """Return the header's stamp in nanoseconds."""
        stamp = self._fields["header"]["stamp"]
        return int(stamp["sec"]) * SECOND + int(stamp["nanosec"])

    def value(self, field: str) -> Any:
        """Return a field by its full name, such as `header.frame_id`."""
        return field_of(self._fields, field)

    def by(self, key: str, field: str) -> dict[str, Any]:
        """Return two lists as a dictionary: `by("name", "velocity")` gives each joint's velocity."""
        return dict(zip(self.value(key), self.value(field), strict=False))


class WorldState(Part):
    """What a world's truth() returned after a step, its values by name; `at` is when that was (s)."""

    def __init__(self, truth: Truth) -> None:
        super().__init__(truth.values)
        self.at = (truth.at - START) / SECOND
        self.at_ns = truth.at


@dataclass(frozen=True)
class Exchange:
    """One message sent, everything that the node answered to it, and what the solution answered.

    `number` counts the messages sent, from 1.
    """

    number: int
    sent: Message
    answers: tuple[Message, ...]
    expected: tuple[Message, ...]


def exchanges(recording: Recording, reference: Recording) -> list[Exchange]:
    """Return each message sent, with the node's answers and the solution's."""
    answers, expected = _answers(recording), _answers(reference)
    return [
        Exchange(i + 1, Message(sent), tuple(answers.get(i, ())), tuple(expected.get(i, ())))
        for i, sent in enumerate(recording.sent)
    ]


def _answers(recording: Recording) -> dict[int, list[Message]]:
    """Return what was received for each message sent, by the index of that message.

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
