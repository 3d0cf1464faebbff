"""A recording: every message sent to a node and received from it, the graph around it, and how it ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

#: How one run ended. `completed`: the node was there from the first message to the last.
RunOutcome = Literal["completed", "did-not-start", "crashed", "timed-out", "over-limit"]

#: A message's fields by name: numbers, texts, lists and further such dictionaries, as its .msg file nests them.
Fields = dict[str, Any]


@dataclass(frozen=True)
class Sent:
    """A message that a reference publisher published at `at` ns of simulated time.

    `heard` is whether the student's node subscribed to its topic then.
    """

    at: int
    topic: str
    type: str
    fields: Fields
    heard: bool = True


@dataclass(frozen=True)
class Received:
    """A message that came from the student's node at `at` ns of simulated time.

    `after` is how many messages had been sent by then: 3 means that it came after the third and before the fourth.
    """

    at: int
    after: int
    topic: str
    type: str
    fields: Fields


@dataclass(frozen=True)
class EndPoint:
    """A publisher or subscription of the student's, as the ROS graph shows it."""

    node: str
    kind: Literal["publisher", "subscription"]
    topic: str
    type: str
    reliability: str
    durability: str


@dataclass(frozen=True)
class Ending:
    """How a run ended, in `story` for the student.

    `interrupted` is whether the node was asked to end by Ctrl-C; then `ended_in_time` tells whether it did so within
    the 2 s it has, and `traceback` whether it printed one. `line` is the line of the student's file that is to blame,
    where that is known.
    """

    outcome: RunOutcome
    story: str = ""
    line: int | None = None
    interrupted: bool = False
    ended_in_time: bool = True
    traceback: str = ""


@dataclass(frozen=True)
class Recording:
    """One spin of one node through one scenario.

    `hold` tells how it was known that the node had handled a message. "lockstep": the middleware said so. The others
    are for Fast DDS: by its parameter services, by its type description service, or by waiting until it was quiet.
    `seconds` is how long the run took in real time, and `lockstep_seconds` the part of it from the first message to the
    last.
    """

    scenario: str
    sent: tuple[Sent, ...]
    received: tuple[Received, ...]
    nodes: tuple[str, ...]
    end_points: tuple[EndPoint, ...]
    hold: Literal["lockstep", "parameters", "type description", "quiet", "none"]
    uses_sim_time: bool
    ending: Ending
    log: str = field(default="", compare=False)
    seconds: float = field(default=0.0, compare=False)
    lockstep_seconds: float = field(default=0.0, compare=False)
