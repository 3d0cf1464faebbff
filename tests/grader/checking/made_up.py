"""Made-up recordings, to test what checks say about them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from grader.checking.run import Run
from grader.checking.verdict import Finding, Wrong
from grader.exercise import Exercise
from grader.exercise.exercise import Parameter, ServiceOrAction, Topic
from grader.recording import Ending, Endpoint, ReceivedMessage, Recording, SentMessage
from grader.scenario.scenario import SECOND, START

FLOAT, STAMPED = "std_msgs/msg/Float64", "geometry_msgs/msg/PointStamped"
ADD, COUNT = "example_interfaces/srv/AddTwoInts", "test_msgs/action/Fibonacci"

EXERCISE = Exercise(
    "all", Path(), "", 10.0, "node.py", "", "worker", "", (Topic("/in", FLOAT, "subscribe"),
    Topic("/out", FLOAT, "publish", units={"data": "m"})), None,
    endpoints=(ServiceOrAction("/add", ADD, "service", {"sum": "m"}), ServiceOrAction("/count", COUNT, "action")),
    parameters=(Parameter("gain", "double", 1.0, "1/s"),),
)  # fmt: skip

#: A node with everything that the exercise asks for.
ENDS = (
    Endpoint("/worker", "subscription", "/in", FLOAT, "reliable", "volatile", 10),
    Endpoint("/worker", "publisher", "/out", FLOAT, "reliable", "volatile", 10),
    Endpoint("/worker", "server", "/add", ADD, "reliable", "volatile", 10),
    Endpoint("/worker", "action server", "/count", COUNT, "reliable", "volatile", 10),
)

EMPTY = Recording("plain", (), (), ("/worker",), ENDS, True, Ending("completed"))


def ns(seconds: float) -> int:
    """Return seconds after the start as simulated time."""
    return START + round(seconds * SECOND)


def published(times: Iterable[float], values: Iterable[float], topic: str = "/out", subscriber: str = "") -> Recording:
    """Return a recording of a node that published these numbers."""
    received = tuple(
        ReceivedMessage(ns(at), 0, topic, FLOAT, {"data": value}, subscriber)
        for at, value in zip(times, values, strict=True)
    )
    return replace(EMPTY, received=received)


def moved(*way: tuple[float, float, float]) -> Recording:
    """Return a recording of a world that published where it was: (time, x, y)."""
    return replace(EMPTY, sent=tuple(SentMessage(ns(at), "/pose", FLOAT, {"x": x, "y": y}) for at, x, y in way))


def run(mine: Recording, reference: Recording | None = None, exercise: Exercise = EXERCISE) -> Run:
    """Return what a check gets."""
    return Run(exercise, mine, reference or mine, "as usual")


def finding(check: Callable[[], Any]) -> Finding:
    """Return what a check says that has to fail."""
    with pytest.raises(Wrong) as caught:
        check()
    return caught.value.finding


def says(check: Callable[[], Any]) -> str:
    """Return the words of a check that has to fail."""
    return finding(check).text
