"""A recording: every message sent to a node and received from it, the graph around it, and how it ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from grader.recording.events import Call, Event, Exit, Fields, Goal, ParameterChange, ParameterReading

__all__ = ["EndPoint", "Ending", "Fields", "Received", "Recording", "RunOutcome", "Sent"]

#: How one run ended. `completed`: the node was there from the first message to the last.
RunOutcome = Literal["completed", "did-not-start", "crashed", "timed-out", "over-limit"]

#: What an end point is. Those of actions are made of five end points each in the ROS graph.
EndPointKind = Literal["publisher", "subscription", "server", "client", "action server", "action client"]


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
    `subscriber` is the name of the scenario's own subscriber that got it, and empty for the recorder, which hears
    everything. `node` is the full name of the node that published it; over Fast DDS it is not known.
    """

    at: int
    after: int
    topic: str
    type: str
    fields: Fields
    subscriber: str = ""
    node: str = field(default="", compare=False)


@dataclass(frozen=True)
class EndPoint:
    """An end point of the student's, as the ROS graph shows it; `topic` is also the name of a service or an action.

    `depth` is 0 for "keep all". `deadline` and `lifespan` are in ns, and None without a limit. Over Fast DDS there are
    publishers and subscriptions only, and these three are not known.
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
    calls: tuple[Call, ...] = ()
    goals: tuple[Goal, ...] = ()
    parameters: tuple[ParameterChange, ...] = ()
    readings: tuple[ParameterReading, ...] = ()
    exits: tuple[Exit, ...] = ()

    @property
    def timeline(self) -> tuple[Event, ...]:
        """Everything that happened, in the order in which it did. What happened at one moment is in a fixed order."""
        found = [Event(one.at, f"sent {one.topic}", one) for one in self.sent]
        found += [Event(one.at, f"received {one.topic}", one) for one in self.received]
        found += [Event(one.at, f"set {one.name}", one) for one in self.parameters]
        found += [Event(one.at, f"read {one.name}", one) for one in self.readings]
        for call in self.calls:
            found.append(Event(call.at, f"request {call.service}", call))
            found += [Event(call.answered, f"response {call.service}", call)] if call.answered is not None else []
        for goal in self.goals:
            found += _of_goal(goal)
        found += [Event(one.at, f"exit {one.program}", one) for one in self.exits]
        return tuple(sorted(found, key=lambda event: event.at))


def likewise(first: Recording, scenario: str) -> Recording:
    """The recording of a scenario that is not spun, because the `first` one has ended before its time."""
    if first.scenario == scenario:
        return first
    ending = Ending(first.ending.outcome, first.ending.story)
    return Recording(scenario, (), (), first.nodes, (), "none", False, ending)


def _of_goal(goal: Goal) -> list[Event]:
    name = f"{goal.action} {goal.number}"
    found = [Event(goal.at, f"goal {name}", goal)]
    found += [Event(one.at, f"state {name}", one) for one in goal.states]
    found += [Event(one.at, f"feedback {name}", one) for one in goal.feedback]
    found += [Event(one.at, f"cancel {name}", one) for one in goal.cancels]
    found += [Event(goal.finished, f"result {name}", goal)] if goal.finished is not None else []
    return found
