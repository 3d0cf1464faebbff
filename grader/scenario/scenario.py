"""A scenario: which messages the reference publishers publish, and when."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import Literal

from grader.recording.recording import Fields

SECOND = 1_000_000_000

#: Simulated time at which every scenario begins. Not 0, which means "no time yet" in ROS.
START = 100 * SECOND

#: What the computer's own clock shows while simulated time goes by: see `grader.runner.clocks`.
ComputerTime = Literal["apart", "simulated"]


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

    `computer_time` says what the computer's clock shows to the node, and what `time.sleep` and wall timers take:
    "simulated" is the same as simulated time; "apart" is more, so that who measures with the wrong clock measures
    something else: 1.25 s for each simulated second.
    """

    name: str
    title: str
    messages: tuple[Message, ...]
    interrupt: bool = False
    computer_time: ComputerTime = "apart"

    @property
    def seconds(self) -> float:
        """How long it lasts, in simulated seconds."""
        return (max(message.at for message in self.messages) - START) / SECOND

    @property
    def digest(self) -> str:
        """The same for two scenarios only if everything in them is."""
        content = asdict(self)
        if self.computer_time == "apart":  # the default, from before there was a choice
            del content["computer_time"]
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
