"""Recordings as JSON, which keeps every number to the last bit."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

from grader.recording import events
from grader.recording.recording import Ending, EndPoint, Received, Recording, Sent

#: Recordings from before there were these have none of them.
_LATER = {
    "calls": events.Call,
    "parameters": events.ParameterChange,
    "readings": events.ParameterReading,
    "exits": events.Exit,
}


def to_json(recordings: dict[str, Recording]) -> str:
    """`recordings` as a text from which `from_json` makes equal ones."""
    return json.dumps(plain(recordings))


def from_json(text: str) -> dict[str, Recording]:
    """The recordings that `to_json` wrote. Raises ValueError, KeyError or TypeError where it did not write them."""
    return from_plain(json.loads(text))


def plain(recordings: dict[str, Recording]) -> dict[str, Any]:
    """`recordings` as dictionaries, lists, texts and numbers."""
    return {name: _plain(recording) for name, recording in recordings.items()}


def _plain(value: Any) -> Any:
    """What `dataclasses.asdict` makes of a recording, without copying the messages' fields, in a third of the time."""
    if isinstance(value, tuple):
        return tuple(_plain(one) for one in value)
    if not dataclasses.is_dataclass(value):
        return value
    return {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}


def from_plain(entries: dict[str, Any]) -> dict[str, Recording]:
    """The recordings that `plain` made such. Raises ValueError, KeyError or TypeError where it did not."""
    return {name: _recording(recording) for name, recording in entries.items()}


def _recording(entries: dict[str, Any]) -> Recording:
    return Recording(
        **{
            **entries,
            "sent": tuple(Sent(**sent) for sent in entries["sent"]),
            "received": tuple(Received(**received) for received in entries["received"]),
            "nodes": tuple(entries["nodes"]),
            "end_points": tuple(EndPoint(**end_point) for end_point in entries["end_points"]),
            "ending": Ending(**entries["ending"]),
            **{name: tuple(kind(**one) for one in entries.get(name, ())) for name, kind in _LATER.items()},
            "goals": tuple(_goal(goal) for goal in entries.get("goals", ())),
        }
    )


def _goal(entries: dict[str, Any]) -> events.Goal:
    return events.Goal(
        **{
            **entries,
            "states": tuple(events.GoalState(**state) for state in entries["states"]),
            "feedback": tuple(events.Feedback(**feedback) for feedback in entries["feedback"]),
            "cancels": tuple(events.Cancel(**cancel) for cancel in entries["cancels"]),
        }
    )
