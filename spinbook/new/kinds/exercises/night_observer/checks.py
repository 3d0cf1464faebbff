"""What every student may read: the checks of `night_observer`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=3,
    hint="send_goal_async() sends a goal.",
)
def test_sends_a_goal(one_star: Run) -> None:
    """It sends the star as a goal for the telescope."""
    one_star.must_have_interface()
    one_star.must_match_goals("theta")


@check(
    points=3,
    hint="The handle has get_result_async(). Add a done-callback to what it returns.",
    depends=[test_sends_a_goal],
)
def test_a_photo_of_what_succeeded(one_star: Run) -> None:
    """When the goal succeeds, it publishes the star on /photo."""
    one_star.must_match_series("data", topic="/photo", time=0.1)
    one_star.must_match_series("data", topic="/missed")


@check(
    points=1,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_sends_a_goal],
)
def test_ends_on_ctrl_c(one_star: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    one_star.must_end_on_ctrl_c()
