"""Recordings of a node's run, as plain data and as JSON, which keeps every number to the last bit."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Literal

from grader.recording.arrays import ArrayEncoder, LongArray, read_arrays
from grader.recording.events import (
    Call,
    Event,
    Fields,
    Goal,
    ParameterChange,
    ParameterReading,
    ProgramExit,
    ProgramStart,
    RecordedMoment,
    Truth,
)
from grader.recording.fields import WithFields
from groundwork.plain_data import restored

__all__ = ["Ending", "Endpoint", "Fields", "ReceivedMessage", "Recording", "RunOutcome", "SentMessage"]

#: How one run ended. `completed`: the node ran from the first message to the last.
RunOutcome = Literal["completed", "did-not-start", "crashed", "timed-out", "over-limit"]

#: What an end point is. Those of actions are made of five end points each in the ROS graph.
EndPointKind = Literal["publisher", "subscription", "server", "client", "action server", "action client"]


@dataclass(frozen=True)
class SentMessage(RecordedMoment, WithFields):
    """A message that a reference publisher published at `at` (s).

    `heard` is whether the student's node subscribed to its topic at that time.
    """

    at_ns: int
    topic: str
    type: str
    fields: Fields
    heard: bool = True


@dataclass(frozen=True)
class ReceivedMessage(RecordedMoment, WithFields):
    """A message from the student's node at `at` (s).

    `after` is how many messages had been sent by then: 3 means after the third and before the fourth.
    `subscriber` is the name of the scenario's own subscriber that got it, and empty for the recorder, which
    receives everything. `node` is the full name of the node that published it. An `unordered` message has no order
    among those of its node and topic at the same moment, because several threads published them.
    """

    at_ns: int
    after: int
    topic: str
    type: str
    fields: Fields
    subscriber: str = ""
    node: str = field(default="", compare=False)
    unordered: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class Endpoint:
    """An end point of the student's, as the ROS graph shows it; `topic` is also the name of a service or an action.

    `kind` is "publisher", "subscription", "server", "client", "action server" or "action client".

    `depth` is 0 for "keep all". `deadline` and `lifespan` are in ns, and None without a limit.
    """

    node: str
    kind: EndPointKind
    topic: str
    type: str
    reliability: str
    durability: str
    depth: int = field(default=0, compare=False)
    deadline: int | None = field(default=None, compare=False)
    lifespan: int | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Ending:
    """How a run ended, in `message` for the student.

    `outcome` is "completed" if the node ran to the end; otherwise "did-not-start", "crashed", "timed-out" or
    "over-limit". `interrupted` is whether the node was asked to end by Ctrl-C; then `ended_in_time` is whether it did
    so within 2 s, and `traceback` whether it printed one. `line` is the line of the student's file that is to blame, if
    known. `survived` says what went wrong inside a program that went on all the same, such as an exception in a thread.
    """

    outcome: RunOutcome
    message: str = ""
    line: int | None = None
    interrupted: bool = False
    ended_in_time: bool = True
    traceback: str = ""
    survived: str = field(default="", compare=False)


@dataclass(frozen=True)
class Recording:
    """One run of one node through one scenario.

    `sent` and `truth` are the scenario's, all else is what the program did. `nodes` are the full names of its nodes,
    `end_points` its ends in the ROS graph, `exits` how programs ended, and `log` is what it printed. `uses_sim_time` is
    whether its clock is the simulated one. `programs` is empty if there is only one.

    `seconds` is how long the run took in real time, and `lockstep_seconds` the part of it from the first message to the
    last.
    """

    scenario: str
    sent: tuple[SentMessage, ...]
    received: tuple[ReceivedMessage, ...]
    nodes: tuple[str, ...]
    end_points: tuple[Endpoint, ...]
    uses_sim_time: bool
    ending: Ending
    log: str = field(default="", compare=False)
    seconds: float = field(default=0.0, compare=False)
    lockstep_seconds: float = field(default=0.0, compare=False)
    calls: tuple[Call, ...] = ()
    goals: tuple[Goal, ...] = ()
    parameters: tuple[ParameterChange, ...] = ()
    readings: tuple[ParameterReading, ...] = ()
    exits: tuple[ProgramExit, ...] = ()
    programs: tuple[ProgramStart, ...] = ()
    truth: tuple[Truth, ...] = ()

    @property
    def timeline(self) -> tuple[Event, ...]:
        """All events in order of time. Events at the same moment are in a fixed order."""
        found = [Event(one.at_ns, f"sent {one.topic}", one) for one in self.sent]
        found += [Event(one.at_ns, f"received {one.topic}", one) for one in self.received]
        found += [Event(one.at_ns, f"set {one.name}", one) for one in self.parameters]
        found += [Event(one.at_ns, f"read {one.name}", one) for one in self.readings]
        for call in self.calls:
            found.append(Event(call.at_ns, f"request {call.service}", call))
            found += [Event(call.answered_ns, f"response {call.service}", call)] if call.answered_ns is not None else []
        for goal in self.goals:
            found += _of_goal(goal)
        found += [Event(one.at_ns, f"exit {one.program}", one) for one in self.exits]
        return tuple(sorted(found, key=lambda event: event.at_ns))


def not_run(scenarios: Iterable[str], ending: Ending) -> dict[str, Recording]:
    """Return the recordings of scenarios in which nothing ran, by their names."""
    return {name: Recording(name, (), (), (), (), False, ending) for name in scenarios}


def not_run_because(first: Recording, scenario: str) -> Recording:
    """Return the recording of a scenario that does not run, because the program ended early in the `first` one."""
    if first.scenario == scenario:
        return first
    ending = Ending(first.ending.outcome, first.ending.message)
    return Recording(scenario, (), (), first.nodes, (), False, ending)


def _of_goal(goal: Goal) -> list[Event]:
    name = f"{goal.action} {goal.number}"
    found = [Event(goal.at_ns, f"goal {name}", goal)]
    found += [Event(one.at_ns, f"state {name}", one) for one in goal.states]
    found += [Event(one.at_ns, f"feedback {name}", one) for one in goal.feedback]
    found += [Event(one.at_ns, f"cancel {name}", one) for one in goal.cancels]
    found += [Event(goal.finished_ns, f"result {name}", goal)] if goal.finished_ns is not None else []
    return found


def to_json(recordings: dict[str, Recording]) -> str:
    """Return `recordings` as JSON, from which `from_json` makes equal ones."""
    return RecordingEncoder(check_circular=False).encode(recordings)


def _fields_of(value: Any) -> dict[str, Any]:
    return {name: getattr(value, name) for name in _names(value.__class__)}


@cache
def _names(kind: Any) -> tuple[str, ...]:
    """Return the names of a dataclass's fields. Raises TypeError for other types, as the encoder expects."""
    return tuple(field.name for field in dataclasses.fields(kind))


class RecordingEncoder(ArrayEncoder):
    """Writes dataclasses in half the time of `dataclasses.asdict`, which copies each message's fields."""

    def default(self, value: Any) -> Any:
        """Return a long array or a part of a recording as JSON has it."""
        return super().default(value) if isinstance(value, LongArray) else _fields_of(value)


def from_json(text: str | bytes) -> dict[str, Recording]:
    """Return the recordings that `to_json` wrote. Raises ValueError, KeyError or TypeError for any other text."""
    return from_plain(json.loads(text, object_hook=read_arrays()))


def from_plain(entries: dict[str, Any]) -> dict[str, Recording]:
    """Return the recordings in what JSON keeps of them. Raises ValueError, KeyError or TypeError for other data."""
    return {name: restored(Recording, recording) for name, recording in entries.items()}
