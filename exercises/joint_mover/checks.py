"""What every student may read: the checks of `joint_mover`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=8,
    hint="What does the goal callback return for this goal? It must be GoalResponse.ACCEPT or GoalResponse.REJECT.",
    rule=("action", "accept"),
)
def test_accepts_a_goal(up: Run) -> None:
    """It has the action /move_joint, accepts a goal within the limits, and takes its time to get there."""
    up.must_have_interface()
    up.must_accept(1)
    goal = up.goal(1)
    ended = next((state.at for state in goal.states if state.state in ("succeeded", "aborted", "canceled")), None)
    if ended is not None and ended - goal.at < 50_000_000:
        text = "it ended as soon as it was accepted: expected a step every 0.1 s."
        up.wrong_at(ended, text, "goal 1", "a step every 0.1 s", "an end at once")


@check(
    points=10,
    hint="When does the loop in execute end, and what does it call on the goal handle then?",
    depends=[test_accepts_a_goal],
    misconception="forgets succeed()",
    rule=("at_goal", "meanwhile"),
)
def test_succeeds(up: Run) -> None:
    """The goal succeeds when the joint is there."""
    up.must_end("succeeded", goal=1)


@check(
    points=12,
    hint="In which order does execute wait, step and publish feedback, and how long is the last step?",
    todo="Go through the loop for the first two steps, with pen and paper. execute waits 0.1 s by the node's "
    "clock, moves the position by one step, and then publishes feedback with the new position. So the first "
    "feedback comes 0.1 s after the goal was accepted, and it is not the old position. The last step is only "
    "as long as what is left, up or down: min() and max() with the goal keep the joint from going beyond it. "
    "The goal itself is the last feedback.",
    depends=[test_accepts_a_goal],
    rule=("steps", "last", "feedback", "start", "clock", "meanwhile"),
    partial=True,
)
def test_feedback_after_each_step(up: Run) -> None:
    """A step of 0.05 rad every 0.1 s, each with feedback."""
    up.must_match_feedback("position", goal=1, time=0.05)


@check(
    points=6,
    hint="Return MoveJoint.Result(position=…).",
    depends=[test_accepts_a_goal],
    rule=("at_goal", "last"),
)
def test_result_is_the_position(up: Run) -> None:
    """The result holds the position where the joint ended."""
    up.must_match_results("position")


@check(
    points=12,
    hint="The cancel callback accepts. Before each step, check goal_handle.is_cancel_requested, and call canceled().",
    depends=[test_accepts_a_goal],
    misconception="cannot be canceled",
    rule=("cancel", "meanwhile"),
)
def test_cancel(canceled: Run) -> None:
    """A goal ends as canceled within 0.1 s after the request."""
    canceled.must_cancel(1, within=0.11)


@check(
    points=3,
    hint="super().__init__('joint_mover')",
    depends=[test_accepts_a_goal],
    rule=("node", "other_topics"),
)
def test_node_is_called_joint_mover(up: Run) -> None:
    """There is one node, it is called joint_mover, and it publishes on no other topics."""
    up.must_have_nodes()
    up.must_publish_on_no_others()


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_accepts_a_goal],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(up: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    up.must_end_on_ctrl_c()
