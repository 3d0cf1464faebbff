"""Messages as a check sees them, and which messages answer which."""

from __future__ import annotations

from dataclasses import dataclass

from grader.recording.events import Truth
from grader.recording.fields import OnTopic, Part
from grader.recording.recording import ReceivedMessage, Recording, SentMessage


class Message(OnTopic, Part):
    """A message that was sent or received: its fields by name, its `stamp` (s), its topic, and when it arrived (s).

    For a sent message, `heard` says whether the student's node subscribed to its topic at that moment; a field that the
    scenario does not give has its default. For a received message, `after` is the number of messages that had been sent
    by then. `at_ns` is its simulated time in nanoseconds.
    """

    at: float
    at_ns: int
    topic: str
    heard: bool
    after: int

    def __init__(self, kept: SentMessage | ReceivedMessage) -> None:
        super().__init__(kept.fields, (kept.type,))
        self.heard = not isinstance(kept, SentMessage) or kept.heard
        self.at, self.at_ns = kept.at, kept.at_ns
        self.after = kept.after if isinstance(kept, ReceivedMessage) else 0
        self.topic = kept.topic


class WorldState(Part):
    """What a world's truth() returned after a step, its values by name; `at` is when that was (s)."""

    at: float
    at_ns: int

    def __init__(self, truth: Truth) -> None:
        super().__init__(truth.values)
        self.at, self.at_ns = truth.at, truth.at_ns


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
