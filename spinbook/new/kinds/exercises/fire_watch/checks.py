"""What every student may read: the checks of `fire_watch`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check, fail


@check(
    points=3,
    hint="call_async() sends a request.",
)
def test_calls_the_sprinkler(fire: Run) -> None:
    """It calls the sprinkler when a fire begins."""
    fire.must_have_interface()
    if not fire.calls(by="node"):
        fail("Your node never calls the sprinkler.", expected="a request to /sprinkler", got="none")


@check(
    points=3,
    hint="A timer publishes. No callback may wait for the sprinkler: with call_async() nothing waits.",
    depends=[test_calls_the_sprinkler],
    misconception="waits in a callback",
)
def test_siren_goes_on(fire: Run) -> None:
    """Every 0.2 s it publishes on /siren whether there is a fire."""
    fire.must_match_series("data", topic="/siren", time=0.05)


@check(
    points=2,
    hint="Remember what you asked for last.",
    depends=[test_calls_the_sprinkler],
)
def test_one_call_for_each_change(fire: Run) -> None:
    """It calls once when a fire begins and once when it is over, each time at once."""
    fire.must_match_requests("data", time=0.05)


@check(
    points=2,
    hint="call_async() returns a future. Add a done-callback to it.",
    depends=[test_calls_the_sprinkler],
)
def test_reports_the_answer(fire: Run) -> None:
    """It reports what the sprinkler answered."""
    fire.must_match_series("data", topic="/report", time=0.1)


@check(
    points=1,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_calls_the_sprinkler],
)
def test_ends_on_ctrl_c(fire: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    fire.must_end_on_ctrl_c()
