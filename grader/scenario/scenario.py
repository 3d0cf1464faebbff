"""A scenario: which messages the reference publishers publish, and when."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass

from grader.recording.recording import Fields

SECOND = 1_000_000_000

#: Simulated time at which every scenario begins. Not 0, which means "no time yet" in ROS.
START = 100 * SECOND


@dataclass(frozen=True)
class Message:
    """One message of a scenario, published at `at` ns of simulated time.

    `publisher` tells publishers on one topic apart: when it changes, the former one is gone.
    """

    at: int
    topic: str
    type: str
    fields: Fields
    publisher: int = 1


@dataclass(frozen=True)
class Scenario:
    """What one spin of a node consists of.

    `name` is the fixture by which checks ask for its recording, `title` says in words what happens. With `interrupt`
    the node is asked to end by Ctrl-C after the last message.
    """

    name: str
    title: str
    messages: tuple[Message, ...]
    interrupt: bool = False

    @property
    def seconds(self) -> float:
        """How long it lasts, in simulated seconds."""
        return (max(message.at for message in self.messages) - START) / SECOND

    @property
    def digest(self) -> str:
        """The same for two scenarios only if everything in them is."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()
