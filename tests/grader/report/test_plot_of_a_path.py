"""Of a closed loop, the plot shows the path in the plane with the goal, and no value that merely differs."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import plain_grades as plain

from grader.checking.verdict import Finding
from grader.exercise import Exercise
from grader.exercise.exercise import Topic
from grader.recording import Ending, Recording
from grader.recording.recording import ReceivedMessage, SentMessage
from grader.report.feedback_plot import feedback_plot
from grader.report.plot import draw
from grader.scenario.scenario import SECOND, START

METRES = {"x": "m", "y": "m"}
POSE = Topic("/pose", "turtlesim/msg/Pose", "subscribe", units={**METRES, "theta": "rad"})
GOAL = Topic("/goal", "geometry_msgs/msg/Point", "subscribe", units=METRES)
COMMAND = Topic("/command", "std_msgs/msg/Float64", "publish", units={"data": "m/s"})
EXERCISE = Exercise("drive", Path(), "Drive", 10.0, "drive.py", "", "drive", "", (POSE, GOAL, COMMAND), None)


def drive(slope: float, count: int = 5) -> Recording:
    """Return a recording of a world that moves along a line, and a goal at 4, 4."""
    times = [START + i * SECOND for i in range(count)]
    sent = [SentMessage(at, "/pose", POSE.type, {"x": float(i), "y": slope * i}) for i, at in enumerate(times)]
    sent.insert(1, SentMessage(START, "/goal", GOAL.type, {"x": 4.0, "y": 4.0}))
    received = tuple(ReceivedMessage(at, 1, "/command", COMMAND.type, {"data": slope}) for at in times)
    return Recording("ahead", tuple(sent), received, (), (), True, Ending("completed"))


def plot_of(mine: Recording, finding: Finding | None = None) -> str:
    verdict = plain.failed(plain.PUBLIC, finding) if finding else plain.PUBLIC
    grade = replace(plain.grade(verdict), recordings={"ahead": mine}, references={"ahead": drive(1.0)})
    plot = feedback_plot(grade, EXERCISE)
    assert plot
    return plot.replace("&#39;", "'")


def test_the_path_the_goal_and_where_it_went_wrong() -> None:
    plot = plot_of(drive(0.5), Finding("At 2.00 s: wrong", "ahead", at=2.0))

    assert "The path in the plane of x and y, yours drawn over the solution's. The goal is at x 4, y 4." in plot
    assert "The cross marks where it went wrong: x 2, y 1 at 2.00 s." in plot
    assert plot.count('class="goal"') == 2, "one in the legend"


def test_another_way_to_the_goal_is_not_called_wrong() -> None:
    plot = plot_of(drive(0.5))

    assert "wrong" not in re.sub(r"<style>.*?</style>", "", plot, flags=re.DOTALL)


def test_a_long_path_is_drawn_to_its_end_and_numbers_that_are_not_finite_are_left_out() -> None:
    long = drive(0.5, 2000)
    broken = SentMessage(START, "/pose", POSE.type, {"x": math.nan, "y": 0.0})

    points = re.findall(r'class="got" points="([^"]*)"', plot_of(replace(long, sent=(broken, *long.sent))))[0].split()

    assert len(points) == 2000
    assert all(re.fullmatch(r"[\d.]+,[\d.]+", point) for point in points)


def test_of_a_loop_with_one_number_the_controlled_number_is_drawn() -> None:
    level = replace(POSE, name="/level", units={"x": "m"})
    exercise = replace(EXERCISE, topics=(level, COMMAND))

    def filled(slope: float) -> Recording:
        return replace(drive(slope), sent=tuple(replace(one, topic="/level") for one in drive(slope).sent[2:]))

    finding = Finding("At 3.00 s: it overshoots", "ahead", at=3.0)
    levels = tuple(replace(one, fields={"x": 2 * one.fields["x"]}) for one in filled(1.0).sent)
    mine = replace(filled(1.0), sent=levels)
    grade = replace(
        plain.grade(plain.failed(plain.PUBLIC, finding)), recordings={"ahead": mine}, references={"ahead": filled(1.0)}
    )

    plot = feedback_plot(grade, exercise)

    assert plot
    assert "The x over 4 s, yours drawn over the solution's." in plot.replace("&#39;", "'")
    assert "at 3.00 s, is marked with a cross." in plot


def test_without_units_the_first_number_that_changes_is_drawn_also_if_the_node_publishes_on_its_own() -> None:
    twist = Topic("/command", "geometry_msgs/msg/TwistStamped", "publish")
    other = replace(twist, name="/other")
    exercise = replace(EXERCISE, topics=(other, twist))

    def driven(speed: float) -> Recording:
        stamps = [{"stamp": {"sec": i, "nanosec": 0}} for i in range(5)]
        fields = [{"header": stamp, "linear": {"x": 0.0, "y": speed * i}} for i, stamp in enumerate(stamps)]
        received = (ReceivedMessage(START + i * SECOND, 0, "/command", twist.type, f) for i, f in enumerate(fields))
        return Recording("ahead", (), tuple(received), (), (), True, Ending("completed"))

    verdict = plain.failed(plain.PUBLIC, Finding("wrong", "ahead", at=0.0))
    grade = replace(plain.grade(verdict), recordings={"ahead": driven(2.0)}, references={"ahead": driven(1.0)})

    plot = feedback_plot(grade, exercise)

    assert plot
    assert "The linear.y over 4 s" in plot
    assert "The first wrong value, at 1.00 s" in plot


def test_the_instructors_picture_shows_the_path_too(tmp_path: Path) -> None:
    grade = plain.grade(plain.failed(plain.PUBLIC, Finding("At 2.00 s: wrong", "ahead", at=2.0)))

    draw(
        replace(grade, recordings={"ahead": drive(0.5)}, references={"ahead": drive(1.0)}), EXERCISE, tmp_path / "a.svg"
    )

    assert "went wrong" in (tmp_path / "a.svg").read_text(encoding="utf-8")
