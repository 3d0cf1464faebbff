"""What every student may read: the checks of `coin_turnstile`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=2,
    hint='Use create_service(Trigger, "/push", …), and a callback that returns the response.',
)
def test_serves_push(visitors: Run) -> None:
    """It responds to each request to /push."""
    visitors.must_have_interface()
    visitors.must_respond("/push")


@check(
    points=4,
    hint="Compare the credit with the price, and set response.success.",
    depends=[test_serves_push],
)
def test_a_visitor_with_enough_gets_through(visitors: Run) -> None:
    """A push succeeds with a credit of 100 cents or more, but not with less."""
    visitors.must_match_responses("success")


@check(
    points=3,
    hint="100 minus the credit is missing. Write it as in the task: 70 cents missing.",
    depends=[test_a_visitor_with_enough_gets_through],
)
def test_a_visitor_with_less_is_told_what_is_missing(visitors: Run) -> None:
    """The message is `welcome`, or says how many cents are missing."""
    visitors.must_match_responses("message")


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_serves_push],
)
def test_ends_on_ctrl_c(visitors: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    visitors.must_end_on_ctrl_c()
