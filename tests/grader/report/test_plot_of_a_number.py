"""A node that publishes one number has a plot, too, with one curve; so has the feedback of an action."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import plain_grades as plain
from small_class import EXERCISE, TEMPLATE

from grader.checking.verdict import Finding
from grader.exercise import load
from grader.exercise.exercise import ServiceOrAction
from grader.recording import Ending, Recording
from grader.recording.events import Feedback, Goal
from grader.recording.recording import ReceivedMessage, SentMessage
from grader.report.curves import curves, drawn_quantity
from grader.report.feedback_plot import feedback_plot
from grader.scenario.scenario import SECOND, START

FLOAT = "std_msgs/msg/Float64"


def recording(*answers: float) -> Recording:
    """Return a recording of numbers that were sent every 0.1 s, and their answers."""
    times = [START + i * SECOND // 10 for i in range(len(answers))]
    sent = tuple(SentMessage(at, "/wanted_speed", FLOAT, {"data": 3.0}) for at in times)
    received = tuple(
        ReceivedMessage(at, i + 1, "/safe_speed", FLOAT, {"data": answer})
        for i, (at, answer) in enumerate(zip(times, answers, strict=True))
    )
    return Recording("gentle", sent, received, (), (), True, Ending("completed", ""))


def test_one_curve_and_where_it_first_goes_wrong() -> None:
    failed = plain.failed(plain.PUBLIC, Finding("wrong", "gentle"))
    right, wrong = recording(1.0, 1.0, 1.0, 1.0), recording(1.0, 1.0, 3.0, 1.0)
    grade = replace(plain.grade(failed), recordings={"gentle": wrong}, references={"gentle": right})
    plot = feedback_plot(grade, load(TEMPLATE / "exercises" / EXERCISE))
    assert plot
    assert plot.count('<polyline class="got"') == 1
    assert "The data over 0.3 s, yours drawn over the solution's." in plot.replace("&#39;", "'")
    assert "The first wrong value, at 0.20 s, is marked with a cross." in plot


def test_nothing_is_marked_where_no_check_failed() -> None:
    allowed, right = recording(1.0, 1.00001), recording(1.0, 1.0)
    grade = replace(plain.grade(plain.PUBLIC, points=6.0), recordings={"gentle": allowed}, references={"gentle": right})
    plot = feedback_plot(grade, load(TEMPLATE / "exercises" / EXERCISE))
    assert plot
    assert "They agree everywhere." in plot


def counted(*counts: int) -> Recording:
    """Return a recording with a count that is published ten times per second, besides the answers."""
    run = recording(1.0, 2.0)
    times = [START + i * SECOND // 20 for i in range(len(counts))]
    more = tuple(
        ReceivedMessage(at, 1, "/count", FLOAT, {"data": count}) for at, count in zip(times, counts, strict=True)
    )
    return replace(run, received=tuple(sorted((*run.received, *more), key=lambda one: one.at)))


def test_the_topic_that_the_finding_names_is_drawn_at_the_times_of_its_messages() -> None:
    exercise = load(TEMPLATE / "exercises" / EXERCISE)
    exercise = replace(exercise, topics=(*exercise.topics, replace(exercise.outputs[0], name="/count")))
    failed = plain.failed(plain.PUBLIC, Finding("expected 1 on /count, got 0.", "gentle", at=0.05))
    runs: dict[str, Any] = {"recordings": {"gentle": counted(0, 0, 0)}, "references": {"gentle": counted(0, 1, 2)}}
    grade = replace(plain.grade(failed), **runs)
    quantity = drawn_quantity(exercise, grade, "gentle")
    assert quantity
    assert quantity.topic == "/count"
    [curve] = curves(grade, exercise, "gentle", quantity)
    assert curve.expected == ((0.0, 0.0), (0.05, 1.0), (0.1, 2.0))
    assert curve.first_wrong == (0.05, 0.0)


def moved(*places: float) -> Recording:
    """Return a recording of one goal with feedback every 0.1 s."""
    feedback = tuple(Feedback(START + i * SECOND // 10, {"position": place}) for i, place in enumerate(places))
    goal = Goal(1, START, "/move", "a/action/Move", {"position": 1.0}, "grader", feedback=feedback)
    return Recording("gentle", (), (), (), (), True, Ending("completed", ""), goals=(goal,))


def test_the_feedback_of_an_action_is_drawn_and_what_is_missing_is_marked() -> None:
    action = ServiceOrAction("/move", "a/action/Move", "action", {"position": "rad"})
    exercise = replace(load(TEMPLATE / "exercises" / EXERCISE), topics=(), endpoints=(action,))
    failed = plain.failed(plain.PUBLIC, Finding("expected 3 feedback messages, got 2.", "gentle", at=0.0))
    runs: dict[str, Any] = {"recordings": {"gentle": moved(0.1, 0.2)}, "references": {"gentle": moved(0.1, 0.2, 0.3)}}
    grade = replace(plain.grade(failed), **runs)
    quantity = drawn_quantity(exercise, grade, "gentle")
    assert quantity
    [curve] = curves(grade, exercise, "gentle", quantity)
    assert (curve.element, curve.first_wrong) == ("goal 1", (0.2, 0.3))
