"""What every student may read: the checks of `speed_limit`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check, fail

WANTED, SAFE = "/wanted_speed", "/safe_speed"
FLOAT = "std_msgs/msg/Float64"


@check(
    points=1,
    hint="Create the subscription and the publisher in __init__, and call publish() in the callback.",
    rule=("ends", "one"),
)
def test_publishes_safe_speeds(gentle: Run) -> None:
    """It subscribes to /wanted_speed and publishes Float64 messages on /safe_speed."""
    if not gentle.subscriptions(WANTED):
        heard = ", ".join(gentle.topics("subscription")) or "none"
        fail("Your node does not subscribe to the topic.", expected=WANTED, got=heard)
    if not gentle.publishers(SAFE):
        published = ", ".join(gentle.topics("publisher")) or "none"
        fail("Your node has no publisher on the topic.", expected=SAFE, got=published)
    for end in (*gentle.subscriptions(WANTED), *gentle.publishers(SAFE)):
        if end.type != FLOAT:
            fail(f"{end.topic} has another type.", expected=FLOAT, got=end.type)
    if not gentle.received:
        fail(f"Nothing was published on {SAFE}.", expected=f"{len(gentle.sent)} messages", got="none")


@check(points=1, hint="One callback, one publish().", depends=[test_publishes_safe_speeds], rule="one")
def test_answers_each_message_once(gentle: Run) -> None:
    """It publishes one message for each message that arrives."""
    gentle.must_answer()


@check(
    points=5,
    hint="min(speed, 1.0) is never greater than 1.0.",
    depends=[test_publishes_safe_speeds],
    rule=("greater", "safe"),
)
def test_too_fast_is_slowed_down(too_fast: Run) -> None:
    """A speed above 1 m/s becomes 1 m/s."""
    too_fast.must_match("data")


@check(
    points=1,
    hint="A speed within the limit is passed on as it is.",
    depends=[test_too_fast_is_slowed_down],
    rule="safe",
)
def test_safe_speeds_pass(gentle: Run) -> None:
    """A speed within the limit is passed on unchanged."""
    gentle.must_match("data")


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_safe_speeds_pass],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(gentle: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    if not gentle.ending.ended_in_time:
        fail("After Ctrl-C the node went on.", expected="an end within 2 s", got="none")
    if gentle.ending.traceback:
        fail("After Ctrl-C the node printed a traceback.", expected="none", got=gentle.ending.traceback)
