"""What every student may read: the checks of `joint_mover`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=8,
    hint="What does the goal callback return for this goal? It must be GoalResponse.ACCEPT or GoalResponse.REJECT.",
    todo="The goal callback gets the goal before anything runs, and returns GoalResponse.ACCEPT or "
    "GoalResponse.REJECT. Compare its position with both limits, which are in rad, and both are allowed. "
    "Returning True, or nothing, is neither of the two. If the goal is accepted but ends at once, look at "
    "execute: between two steps it has to wait 0.1 s by the node's clock.",
    rule=("action", "accept"),
)
def test_accepts_a_goal(up: Run) -> None:
    """It has the action /move_joint, accepts a goal within the limits, and takes its time to get there."""
    up.must_have_interface()
    up.must_accept(1)
    goal = up.goal(1)
    ended = next((state.at for state in goal.states if state.state in ("succeeded", "aborted", "canceled")), None)
    if ended is not None and ended - goal.at < 0.0499:
        text = "it ended as soon as it was accepted: expected a step every 0.1 s."
        up.wrong_at(ended, text, "goal 1", "a step every 0.1 s", "an end at once")


@check(
    points=10,
    hint="When does the loop in execute end, and what does it call on the goal handle then?",
    todo="execute goes on until the position is the goal, calls succeed() on its goal handle, and returns a "
    "Result. After many steps of 0.05, the sum is rarely exactly the goal: limit the last step to what is "
    "left, so that the two become equal, and the loop ends. Every way out of execute needs one of "
    "succeed(), canceled() and abort() before its return. Without one, the goal counts as aborted.",
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
    todo="What execute returns is the result, whatever way the goal ended. Make a MoveJoint.Result, set its "
    "field position to the place where the joint is at that moment, and return it. A bare `return` or "
    "Result() says 0.0. Do not return the goal's position: after a cancel the joint is somewhere else.",
    depends=[test_accepts_a_goal],
    rule=("at_goal", "last"),
)
def test_result_is_the_position(up: Run) -> None:
    """The result holds the position where the joint ended."""
    up.must_match_results("position")


@check(
    points=12,
    hint="The cancel callback accepts. Before each step, check goal_handle.is_cancel_requested, and call canceled().",
    todo="Two things have to work together. The cancel callback, an argument of ActionServer, returns "
    "CancelResponse.ACCEPT; without it, every request is rejected. And execute looks at "
    "goal_handle.is_cancel_requested after each wait and before the next step. If it is true, execute "
    "calls canceled() and returns a Result, with no further step. Both can only run at once with a "
    "MultiThreadedExecutor and a ReentrantCallbackGroup.",
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
