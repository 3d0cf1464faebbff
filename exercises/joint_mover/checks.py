"""What every student may read: the checks of `joint_mover`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check, fail


@check(points=8, hint="Create the ActionServer in __init__. goal_callback returns GoalResponse.ACCEPT.")
def test_accepts_a_goal(up: Run) -> None:
    """It has the action /move_joint, and accepts a goal within the limits."""
    up.must_have_interface()
    up.must_accept(1)


@check(
    points=10,
    hint="At the goal, mark the goal handle as succeeded.",
    depends=[test_accepts_a_goal],
    misconception="forgets succeed()",
)
def test_succeeds(up: Run) -> None:
    """The goal succeeds when the joint has had the time for its steps."""
    up.must_end("succeeded", goal=1, within=1.0)


@check(
    points=12,
    hint="After each step: goal_handle.publish_feedback(MoveJoint.Feedback(position=…)).",
    depends=[test_accepts_a_goal],
)
def test_feedback_after_each_step(up: Run) -> None:
    """A step of 0.05 rad every 0.1 s, each with feedback."""
    up.must_match_feedback("position", goal=1, time=0.05)


@check(points=6, hint="Return MoveJoint.Result(position=…).", depends=[test_succeeds])
def test_result_is_the_position(up: Run) -> None:
    """The result holds the position where the joint ended."""
    up.must_match_results("position")


@check(
    points=12,
    hint="The cancel callback accepts. Before each step, check goal_handle.is_cancel_requested, and call canceled().",
    depends=[test_succeeds],
    misconception="cannot be canceled",
)
def test_cancel(canceled: Run) -> None:
    """A goal ends as canceled within 0.1 s after the request."""
    canceled.must_cancel(1, within=0.11)


@check(points=3, hint="super().__init__('joint_mover')", depends=[test_accepts_a_goal])
def test_node_is_called_joint_mover(up: Run) -> None:
    """There is one node, it is called joint_mover, and it publishes on no other topics."""
    up.must_have_nodes()
    declared = {topic.name for topic in up.exercise.outputs}
    if others := sorted({end.topic for end in up.end_points("publisher")} - declared):
        fail("Your node publishes on other topics, too.", expected="none", got=", ".join(others))


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_accepts_a_goal],
)
def test_ends_on_ctrl_c(up: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    up.must_end_on_ctrl_c()
