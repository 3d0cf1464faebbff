"""The names that an exercise and its scenarios have: topics, services, actions, parameters, and the fields of types."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from grader.checking.closed_loops import TRUTH
from grader.checking.existing_names import OF_EVERY_NODE
from grader.exercise.exercise import Exercise, Role
from grader.recording.types import message_class
from grader.scenario.command_line import programs_of, starts
from grader.scenario.scenario import Message, Request, Scenario, SendGoal, SetParameter, Subscribe
from grader.scenario.servers import ActionServer, Server
from ros_in_python.field_path import steps_of


@dataclass
class KnownNames:
    """All names. `topics`, `services` and `actions` have their types; `received` and `sent` are types of messages.

    It is not `complete` if programs of the author's publish on topics that nothing declares.
    """

    exercise: Exercise
    scenarios: set[str] = field(default_factory=set)
    topics: dict[str, str] = field(default_factory=dict)
    services: dict[str, str] = field(default_factory=dict)
    actions: dict[str, str] = field(default_factory=dict)
    parameters: set[str] = field(default_factory=set)
    subscribers: set[str] = field(default_factory=set)
    programs: set[str] = field(default_factory=set)
    truth: set[str] = field(default_factory=set)
    complete: bool = True

    @property
    def received(self) -> list[str]:
        """The types of what the student's node publishes."""
        return sorted({topic.type for topic in self.exercise.outputs})

    @property
    def sent(self) -> list[str]:
        """The types of what the grader and the world publish."""
        outputs = {topic.name for topic in self.exercise.outputs}
        return sorted({type_ for name, type_ in self.topics.items() if type_ and name not in outputs})

    def parts(self, role: Role, part: str) -> list[str]:
        """Return the parts of services or actions of a role, such as `std_srvs/srv/Trigger.Response`."""
        return sorted({f"{end.type}.{part}" for end in self.exercise.of_role(role)})


def of(exercise: Exercise, scenarios: tuple[Scenario, ...]) -> KnownNames:
    """Return the names of an exercise and its scenarios, whose types have been resolved."""
    names = KnownNames(exercise, {scenario.name for scenario in scenarios})
    names.topics |= {topic.name: topic.type for topic in exercise.topics} | dict.fromkeys((TRUTH, *OF_EVERY_NODE), "")
    names.parameters |= {parameter.name for parameter in exercise.parameters}
    for end in exercise.endpoints:
        (names.actions if end.role.startswith("action") else names.services)[end.name] = end.type
    for scenario in scenarios:
        _add(names, scenario)
    return names


def _add(names: KnownNames, scenario: Scenario) -> None:
    names.complete &= not scenario.companions
    names.programs |= {one.id for one in programs_of(names.exercise, scenario)}
    for step in scenario.content:
        if isinstance(step, Message):
            names.topics[step.topic] = step.type
        elif isinstance(step, Subscribe):
            names.topics[step.topic] = step.type
            names.subscribers.add(step.name)
        elif isinstance(step, Request):
            names.services[step.service] = step.type
        elif isinstance(step, SendGoal):
            names.actions[step.action] = step.type
        elif isinstance(step, SetParameter):
            names.parameters.add(step.name)
    for server in scenario.servers:
        if isinstance(server, Server):
            names.services[server.service] = server.type
        elif isinstance(server, ActionServer):
            names.actions[server.action] = server.type
    if scenario.world:
        model = scenario.world.begin()
        names.topics |= {**model.reads, **model.publishes}
        names.truth |= set(getattr(model, "truth", dict)())
    _in_namespaces(names, scenario)


def _in_namespaces(names: KnownNames, scenario: Scenario) -> None:
    for start in starts(names.exercise, scenario):
        for known in (names.topics, names.services, names.actions):
            for name, type_ in list(known.items()):
                for full in (name, f"{start.namespace}{name}"):
                    known.setdefault(full, type_)
                    known.setdefault(start.resolved(full), type_)


_LIST = re.compile(r"sequence<(.+?)(?:, \d+)?>|(.+)\[\d+\]")


@cache
def fields(type_name: str) -> dict[str, str]:
    """Return the fields of `std_msgs/msg/String` or `std_srvs/srv/Trigger.Response` and their types; {} if unknown."""
    name, _, part = type_name.partition(".")
    try:
        kind: Any = message_class(name)
        known: dict[str, str] = (getattr(kind, part) if part else kind).get_fields_and_field_types()
    except (ImportError, AttributeError, ValueError):
        return {}
    return known


def nested(type_name: str, name: str) -> str:
    """Return the type of a field that is itself a message; empty for any other."""
    type_ = fields(type_name).get(name, "")
    return "" if _LIST.fullmatch(type_) else _message_type(type_)


def element(type_name: str, name: str) -> str:
    """Return the type of the messages in a field that is a list of messages; empty for any other."""
    match = _LIST.fullmatch(fields(type_name).get(name, ""))
    return _message_type(match[1] or match[2]) if match else ""


def _message_type(type_: str) -> str:
    package, _, short = type_.partition("/")
    return f"{package}/msg/{short}" if short else ""


def has(type_name: str, path: str) -> bool:
    """Return whether a type has the field at a path, such as `pose.position.x`; True if the type is unknown."""
    here = type_name
    for step in steps_of(path):
        known = fields(here)
        if isinstance(step, int) or not known:
            continue
        if step not in known:
            return False
        here = element(here, step) or nested(here, step)
    return True
