"""What every student may read: the checks of `ship_autopilot`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=3,
    hint="One publish() in the callback of the heading, whatever the angle.",
)
def test_answers_each_heading(bench: Run) -> None:
    """It publishes one message on /rudder for each heading."""
    bench.must_have_interface()
    headings = [one for one in bench.recording.sent if one.topic == "/heading"]
    bench.must_publish("/rudder", count=len(headings))


@check(
    points=3,
    hint="The rudder is proportional to the course minus the heading.",
    depends=[test_answers_each_heading],
    misconception="the wrong sign",
)
def test_turns_towards_the_course(bench: Run) -> None:
    """The rudder turns the ship towards its course."""
    solution = bench.messages_on("/rudder", reference=True)
    for one, expected in zip(bench.messages_on("/rudder"), solution, strict=False):
        angle, right = one.fields["data"], expected.fields["data"]
        if abs(right) > 0.1 and angle * right <= 0:
            text = f"expected an angle {'above' if right > 0 else 'below'} 0, got {angle:.3g} rad."
            bench.wrong_at(one.at, text, "/rudder", "the other sign", f"{angle:.3g} rad")


@check(
    points=1,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_answers_each_heading],
)
def test_ends_on_ctrl_c(bench: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    bench.must_end_on_ctrl_c()
