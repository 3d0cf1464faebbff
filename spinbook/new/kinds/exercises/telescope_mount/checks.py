"""What every student may read: the checks of `telescope_mount`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=3,
    hint="Call succeed() at the end of execute, and return the result. Spin with a MultiThreadedExecutor.",
)
def test_serves_a_goal(one_goal: Run) -> None:
    """It accepts a goal, and the goal succeeds."""
    one_goal.must_have_interface()
    one_goal.must_end("succeeded")


@check(
    points=3,
    hint="Every 0.5 s: turn first, then publish the goal minus the new angle.",
    depends=[test_serves_a_goal],
)
def test_feedback_after_each_step(one_goal: Run) -> None:
    """After each step, it publishes how far it still has to turn."""
    one_goal.must_match_feedback("remaining", tolerance=1e-4, time=0.05)


@check(
    points=2,
    hint="The angle at the end minus the angle at the beginning.",
    depends=[test_serves_a_goal],
)
def test_result_says_how_far_it_turned(one_goal: Run) -> None:
    """The result says by how much it turned."""
    one_goal.must_match_results("delta", tolerance=1e-4)


@check(
    points=1,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_serves_a_goal],
)
def test_ends_on_ctrl_c(one_goal: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    one_goal.must_end_on_ctrl_c()
