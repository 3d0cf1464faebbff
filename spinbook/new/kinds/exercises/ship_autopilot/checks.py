"""What every student may read: the checks of `ship_autopilot`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=3,
    hint="One publish() in the callback of the heading, whatever the angle.",
)
def test_answers_each_heading(left: Run) -> None:
    """It publishes one message on /rudder for each heading."""
    left.must_have_interface()
    headings = [one for one in left.recording.sent if one.topic == "/heading" and one.heard]
    left.must_publish("/rudder", count=len(headings))


@check(
    points=4,
    hint="The rudder is proportional to the course minus the heading.",
    depends=[test_answers_each_heading],
)
def test_reaches_a_course_to_the_left(left: Run) -> None:
    """It reaches a course to the left, and stays there."""
    left.must_reach("/turned", {"data": 1.0}, tolerance=0.05, within=12.0, start=1.05)


@check(
    points=1,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_answers_each_heading],
)
def test_ends_on_ctrl_c(left: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    left.must_end_on_ctrl_c()
