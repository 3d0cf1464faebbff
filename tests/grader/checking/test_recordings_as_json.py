"""Recordings are kept as JSON, from which equal ones are read."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import pytest
from made_up import ADD, COUNT, EMPTY, moved, ns, published

from grader.recording import Call, Goal
from grader.recording.events import GoalState
from grader.recording.recording import from_json, to_json

CALL = Call(ns(0.5), "/add", ADD, {"a": 1}, "grader", ns(0.6), {"sum": 1})
GOAL = Goal(1, ns(0.5), "/count", COUNT, {"order": 2}, "grader", states=(GoalState(ns(0.6), "executing"),))

RECORDINGS = {
    "numbers": published([0.1, 0.2], [1.5, -0.0]),
    "world": moved((0.0, 1.0, 2.0), (0.1, 1e-9, float("inf"))),
    "calls": replace(EMPTY, calls=(CALL,), goals=(GOAL,)),
}


def test_they_are_read_as_they_were_written() -> None:
    assert from_json(to_json(RECORDINGS)) == RECORDINGS


def test_the_text_is_that_of_their_plain_form() -> None:
    plain = {name: asdict(recording) for name, recording in RECORDINGS.items()}
    assert to_json(RECORDINGS) == json.dumps(plain)


def test_what_is_no_recording_is_refused() -> None:
    with pytest.raises(TypeError):
        to_json({"numbers": object()})  # type: ignore[dict-item]
