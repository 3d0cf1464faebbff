"""Simulated time, and what can happen in it besides messages: calls, goals, parameters, and programs that end.

Each time is there twice: `at` in seconds after the start, and `at_ns` in ns of simulated time. None is "never".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

#: Simulated time counts nanoseconds.
SECOND = 1_000_000_000

#: Simulated time at which every scenario begins. Not 0, which means "no time yet" in ROS.
START = 100 * SECOND

#: A message's fields by name: numbers, texts, lists and nested dictionaries.
Fields = dict[str, Any]

#: Who sent the request: the grader, or the student's node.
By = Literal["grader", "node"]

#: The states of action_msgs/msg/GoalStatus, by their numbers.
STATES = ("unknown", "accepted", "executing", "canceling", "succeeded", "canceled", "aborted")


def seconds(moment: int) -> float:
    """Return a moment of simulated time (ns) as seconds after the start."""
    return (moment - START) / SECOND


class RecordedMoment:
    """What happened at a moment."""

    at_ns: int

    @property
    def at(self) -> float:
        """Return when it was, in seconds after the start."""
        return seconds(self.at_ns)


class RecordedRequest(RecordedMoment):
    """What may be answered later."""

    answered_ns: int | None

    @property
    def answered(self) -> float | None:
        """Return when it was answered, in seconds after the start; None without an answer."""
        return None if self.answered_ns is None else seconds(self.answered_ns)


@dataclass(frozen=True)
class Call(RecordedRequest):
    """One request to a service at `at`, and its response.

    `by` is "grader" for a call of the student's service, and "node" for a request that the student's node sent to a
    reference server; `node` is then the full name of that node. `answered` and `response` are None if there was no
    response. `served` is False if there was no server.
    """

    at_ns: int
    service: str
    type: str
    request: Fields
    by: By
    answered_ns: int | None = None
    response: Fields | None = None
    node: str = ""
    served: bool = True


@dataclass(frozen=True)
class GoalState(RecordedMoment):
    """A state of a goal on the action's raw status topic, such as "executing"."""

    at_ns: int
    state: str


@dataclass(frozen=True)
class Feedback(RecordedMoment):
    """One message of the action's raw feedback topic."""

    at_ns: int
    fields: Fields


@dataclass(frozen=True)
class Cancel(RecordedRequest):
    """A request to cancel a goal. `accepted` is whether the response names the goal; `code` is its return_code."""

    at_ns: int
    answered_ns: int | None = None
    accepted: bool | None = None
    code: int | None = None


@dataclass(frozen=True)
class Goal(RecordedRequest):
    """One goal, from the request to the result.

    Goals count from 1 (`number`), in the order in which they were sent. `by` is "grader" for a goal for the student's
    action server, and "node" for one that the student's node sent to a scripted action server; `node` is then the full
    name of that node, and `asked_result` is when it requested the result. `accepted` is None without an answer.
    `status` and `result` are from the response to that request, at `finished`.
    """

    number: int
    at_ns: int
    action: str
    type: str
    goal: Fields
    by: By
    accepted: bool | None = None
    answered_ns: int | None = None
    states: tuple[GoalState, ...] = ()
    feedback: tuple[Feedback, ...] = ()
    cancels: tuple[Cancel, ...] = ()
    status: str = ""
    result: Fields | None = None
    finished_ns: int | None = None
    asked_result_ns: int | None = None
    node: str = ""

    @property
    def finished(self) -> float | None:
        """Return when the result came, in seconds after the start; None without one."""
        return None if self.finished_ns is None else seconds(self.finished_ns)

    @property
    def asked_result(self) -> float | None:
        """Return when the node requested the result, in seconds after the start; None if it did not."""
        return None if self.asked_result_ns is None else seconds(self.asked_result_ns)


@dataclass(frozen=True)
class ParameterChange(RecordedRequest):
    """The grader set a parameter. `taken` is None if there was no answer; `reason` is the reason for a refusal."""

    at_ns: int
    node: str
    name: str
    value: Any
    taken: bool | None = None
    reason: str = ""
    answered_ns: int | None = None


@dataclass(frozen=True)
class ParameterReading(RecordedRequest):
    """The grader read a parameter. `value` is None if it is not set or not declared, or if there was no answer."""

    at_ns: int
    node: str
    name: str
    value: Any = None
    answered_ns: int | None = None


@dataclass(frozen=True)
class ProgramExit(RecordedMoment):
    """One of several programs ended. `by` is "grader" if the scenario killed it."""

    at_ns: int
    program: str
    code: int | None = None
    signal: int | None = None
    by: Literal["grader", "itself"] = "itself"


@dataclass(frozen=True)
class ProgramStart:
    """A program as the scenario starts it: its name, the node that it is to create, its namespace and remappings.

    `remappings` are from full name to full name.
    """

    name: str
    node: str
    namespace: str = ""
    remappings: dict[str, str] = field(default_factory=dict)

    def resolved(self, name: str) -> str:
        """Return what the full `name` that a program gives becomes."""
        return self.remappings.get(name, name)


@dataclass(frozen=True)
class Truth(RecordedMoment):
    """What a world's truth() returned after a step: nothing of it reaches the student's program."""

    at_ns: int
    values: Fields


@dataclass(frozen=True)
class Event(RecordedMoment):
    """One entry of a timeline: `what` happened at `at`; `item` is the record that it belongs to."""

    at_ns: int
    what: str
    item: Any = field(repr=False)
