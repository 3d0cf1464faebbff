"""What every student may read: the checks of `lighthouse_beam`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=2,
    hint="Create a timer in __init__. It calls a method, and the method calls publish().",
)
def test_publishes_the_beam(six_seconds: Run) -> None:
    """It publishes messages on /beam."""
    six_seconds.must_have_interface()
    six_seconds.must_publish("/beam")


@check(
    points=4,
    hint="self.create_timer(0.2, …) uses the node's clock. time.sleep() uses the computer's.",
    depends=[test_publishes_the_beam],
    misconception="the computer's clock",
)
def test_five_messages_per_second(six_seconds: Run) -> None:
    """It publishes one message every 0.2 s of the node's clock."""
    six_seconds.must_keep_rate(5.0)
    six_seconds.must_have_no_gap(0.22)


@check(
    points=4,
    hint="Start at an angle of 0, and add math.radians(18) after each message. x is the cosine, y the sine.",
    depends=[test_five_messages_per_second],
)
def test_beam_turns(six_seconds: Run) -> None:
    """The first message points along x, and the beam turns by 18° counter-clockwise from one message to the next."""
    six_seconds.must_match_series("vector", tolerance=1e-3)


@check(
    points=3,
    hint="Call self.get_clock().now().to_msg() again for each message.",
    depends=[test_publishes_the_beam],
    misconception="another clock for the stamp",
)
def test_stamp_is_the_nodes_clock(six_seconds: Run) -> None:
    """Each stamp is the time of the node's clock when the message is published."""
    six_seconds.must_stamp(within=0.02)


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_publishes_the_beam],
)
def test_ends_on_ctrl_c(six_seconds: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    six_seconds.must_end_on_ctrl_c()
