"""Says in what a program's recording differs from the solution's: to the last bit of every message."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from grader.recording import Received, Recording


@dataclass(frozen=True)
class Difference:
    """One thing that differs in one scenario, in words."""

    scenario: str
    what: str


def differences(recording: Recording, reference: Recording) -> tuple[Difference, ...]:
    """Everything that can be seen of a node from outside and differs: messages, graph, how it ended. Its log is not."""
    found: list[str] = []
    if recording.ending != reference.ending:
        found.append(f"it ended otherwise: {recording.ending.story or recording.ending.traceback or 'not in time'}")
    if recording.nodes != reference.nodes:
        found.append(f"nodes {_named(recording.nodes)}, the solution's {_named(reference.nodes)}")
    found += _ends(recording, reference)
    if recording.hold != reference.hold or recording.uses_sim_time != reference.uses_sim_time:
        found.append("its services or its clock differ")
    found += _messages(recording.received, reference.received)
    found += _events(recording, reference)
    return tuple(Difference(recording.scenario, what) for what in found)


def _named(names: tuple[str, ...]) -> str:
    return ", ".join(names) or "none"


def _ends(recording: Recording, reference: Recording) -> list[str]:
    mine, its = Counter(recording.end_points), Counter(reference.end_points)
    words = (("more", mine - its), ("fewer", its - mine))
    return [
        f"one {end.kind} {word}: {end.topic} ({end.type}, {end.reliability}, {end.durability})"
        for word, ends in words
        for end in ends.elements()
    ]


def _messages(mine: tuple[Received, ...], its: tuple[Received, ...]) -> list[str]:
    if len(mine) != len(its):
        return [f"{len(mine)} messages, the solution's {len(its)}"]
    fields: Counter[str] = Counter()
    for message, other in zip(mine, its, strict=True):
        if (message.at, message.after, message.topic) != (other.at, other.after, other.topic):
            fields["when they came"] += 1
        fields.update(name for name in other.fields if _text(message.fields.get(name)) != _text(other.fields[name]))
    return [f"{count} of {len(its)} messages differ in {name}" for name, count in sorted(fields.items())]


def _events(recording: Recording, reference: Recording) -> list[str]:
    """What differs in calls, goals, parameters and ends of programs."""
    found = []
    events: tuple[tuple[str, Sequence[Any], Sequence[Any]], ...] = (
        ("calls of services", recording.calls, reference.calls),
        ("goals", recording.goals, reference.goals),
        ("settings of parameters", recording.parameters, reference.parameters),
        ("readings of parameters", recording.readings, reference.readings),
        ("ends of programs", recording.exits, reference.exits),
    )
    for name, mine, its in events:
        if len(mine) != len(its):
            found.append(f"{len(mine)} {name}, the solution's {len(its)}")
        elif differ := sum(_text(asdict(one)) != _text(asdict(other)) for one, other in zip(mine, its, strict=True)):
            found.append(f"{differ} of {len(its)} {name} differ")
    return found


def _text(value: Any) -> str:
    """NaN is not equal to itself; its text is."""
    return json.dumps(value, sort_keys=True)
