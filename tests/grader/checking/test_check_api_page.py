"""The reference page of the check API is made from the docstrings, lists every helper, and its examples run."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import check_api_page
import pytest
from made_up import ADD, COUNT, EMPTY, EXERCISE, FLOAT, STAMPED, ns

import grader.scenario
from grader.checking import Run, Wrong, check, each, fail
from grader.exercise.exercise import ServiceOrAction, Topic
from grader.recording import Ending, Endpoint, ReceivedMessage, Recording, SentMessage
from grader.recording.events import (
    Call,
    Cancel,
    Feedback,
    Goal,
    GoalState,
    ParameterChange,
    ParameterReading,
    Truth,
)
from grader.scenario import numbers, times

PAGE = Path(__file__).parents[3] / "docs" / "check-api.md"

CHANGE = ("/worker/change_state", "lifecycle_msgs/srv/ChangeState")

#: These say what is wrong, so they end the check.
FAILING = ("fail", "run.wrong", "run.wrong_at")

#: These look at the whole interface.
OF_ALL = ("run.must_be_as_declared", "run.must_publish_on_no_others", "run.must_have_interface", "run.topics")


def goal(number: int, *states: str, **others: Any) -> Goal:
    at = ns(number)
    moments = tuple(GoalState(at + 10**8 * place, state) for place, state in enumerate(states))
    return Goal(number, at, "/count", COUNT, {"order": 3}, "grader", bool(states), at, moments, **others)


def everything() -> Recording:
    """A recording with all that the examples are about."""
    times = [number / 10 for number in range(10)]
    stamp = [{"sec": 100, "nanosec": round(at * 10**9)} for at in times]
    sent = tuple(SentMessage(ns(at), "/in", FLOAT, {"data": at}) for at in times)
    out = [ReceivedMessage(ns(at), i + 1, "/out", FLOAT, {"data": at + 0.05}) for i, at in enumerate(times)]
    point = [
        ReceivedMessage(ns(at), i + 1, "/point", STAMPED, {"header": {"stamp": time}})
        for i, (at, time) in enumerate(zip(times, stamp, strict=True))
    ]
    done = {"status": "succeeded", "result": {"sequence": [0, 1]}, "finished_ns": ns(2)}
    feedback = (Feedback(ns(1.1), {"sequence": [0]}),)
    canceled = {"cancels": (Cancel(ns(3.1), ns(3.2), True, 0),), "status": "canceled", "finished_ns": ns(3.3)}
    goals = (
        goal(1, "accepted", "executing", "succeeded", feedback=feedback, **done),
        goal(2),
        goal(3, "accepted", "executing", "canceling", "canceled", **canceled),
        Goal(1, ns(0.5), "/climb", COUNT, {"order": 1}, "node", True, ns(0.5)),
    )
    calls = (
        Call(ns(0.5), "/add", ADD, {"a": 1, "b": 2}, "grader", ns(0.55), {"sum": 3}),
        Call(ns(0.6), "/ask", ADD, {"a": 1, "b": 2}, "node", ns(0.65), {"sum": 3}),
        Call(ns(0.7), *CHANGE, {"transition": {"label": "activate"}}, "grader", ns(0.7), {"success": True}),
    )
    ends = [Endpoint("/worker", "publisher", "/point", STAMPED, "reliable", "volatile", 10)]
    ends += [
        Endpoint("/worker", "client", "/ask", ADD, "reliable", "volatile", 10),
        Endpoint("/worker", "action client", "/climb", COUNT, "reliable", "volatile", 10),
    ]
    return replace(
        EMPTY,
        sent=sent,
        received=tuple(sorted([*out, *point], key=lambda one: one.at)),
        end_points=(*(replace(end, depth=10) for end in EMPTY.end_points), *ends),
        ending=Ending("completed", interrupted=True),
        goals=goals,
        calls=calls,
        parameters=(
            ParameterChange(ns(0.5), "/worker", "gain", 3.0, True, "", ns(0.5)),
            ParameterChange(ns(0.6), "/worker", "gain", -1.0, False, "no", ns(0.6)),
        ),
        readings=(ParameterReading(ns(0.7), "/worker", "gain", 3.0, ns(0.7)),),
        truth=tuple(Truth(ns(at), {"level": at + 0.1}) for at in times),
    )


def run() -> Run:
    endpoints = (
        *EXERCISE.endpoints,
        ServiceOrAction("/ask", ADD, "client"),
        ServiceOrAction("/climb", COUNT, "action_client"),
    )
    topics = (*EXERCISE.topics, Topic("/point", STAMPED, "publish"))
    recording = everything()
    return Run(replace(EXERCISE, endpoints=endpoints, topics=topics), recording, recording, "as usual")


def only(run: Run) -> Run:
    """Return the run of an exercise whose only topic of the node's is /out, as the helpers for answers expect."""
    exercise = replace(run.exercise, topics=EXERCISE.topics)
    return replace(run.on("/out"), exercise=exercise)


def test_the_page_is_made_from_the_docstrings() -> None:
    assert PAGE.read_text() == check_api_page.page(), "make it again: see tests/support/check_api_page.py"


def test_every_helper_has_an_example() -> None:
    named = {heading.partition("(")[0] for heading in check_api_page.examples()}
    helpers = {f"run.{name}" for name in vars(Run) if not name.startswith("_")}
    assert helpers - named == set()


def test_the_scenario_of_the_examples_has_what_they_name() -> None:
    names = {**vars(grader.scenario), **vars(numbers), **vars(times)}
    exec(check_api_page.HEAD.rpartition("```python\n")[2].partition("```")[0], names)
    (scenario,) = names["scenarios"](1)
    parts = (*scenario.messages, *scenario.steps, *scenario.servers)
    known = {getattr(part, key, "") for part in parts for key in ("topic", "service", "action")}
    assert known >= {"/in", "/add", "/count", "/ask", "/climb"}


@pytest.mark.parametrize(
    ("heading", "example"), check_api_page.examples().items(), ids=lambda text: text.partition("(")[0]
)
def test_an_example_runs(heading: str, example: str) -> None:
    name = heading.partition("(")[0]
    whole = run()
    of_all = name in OF_ALL or "/point" in example
    names: dict[str, Any] = {"run": whole if of_all else only(whole)}
    names |= {"each": each, "fail": fail, "check": check}
    if name in FAILING:
        with pytest.raises(Wrong):
            exec(example, names)
    else:
        exec(example, names)
