"""A node that publishes one number has a plot, too, with one curve."""

from __future__ import annotations

from dataclasses import replace

import plain_grades as plain
from small_class import EXERCISE, TEMPLATE

from grader.checking.verdict import Finding
from grader.exercise import load
from grader.recording import Ending, Recording
from grader.recording.recording import ReceivedMessage, SentMessage
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
    return Recording("gentle", sent, received, (), (), "parameters", True, Ending("completed", ""))


def test_one_curve_and_where_it_first_goes_wrong() -> None:
    failed = plain.failed(plain.PUBLIC, Finding("wrong", "gentle"))
    right, wrong = recording(1.0, 1.0, 1.0, 1.0), recording(1.0, 1.0, 3.0, 1.0)
    grade = replace(plain.grade(failed), recordings={"gentle": wrong}, references={"gentle": right})
    plot = feedback_plot(grade, load(TEMPLATE / "exercises" / EXERCISE))
    assert plot
    assert plot.count('<polyline class="got"') == 1
    assert "The data over 0.3 s, yours drawn over the solution's." in plot.replace("&#39;", "'")
    assert "The first wrong value, at 0.20 s, is marked with a cross." in plot
