"""What every student may read: the checks of `joint_operator`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the servers that misbehave.
"""

from __future__ import annotations

import itertools
import math

from grader.checking import Run, check

OUTCOMES, PROGRESS = "/outcomes", "/progress"
ENDS = ("succeeded", "canceled", "aborted")


def must_report_every_end(run: Run) -> None:
    """Fail unless each of the node's goals has its outcome, as it ended, within 0.3 s after its end."""
    ended = []
    for goal in run.goals(by="node"):
        last = goal.states[-1] if goal.states else None
        if goal.accepted is False:
            ended.append(("rejected", goal.answered or goal.at))
        elif last and last.state in ENDS:
            ended.append((last.state, last.at))
    published = run.messages_on(OUTCOMES)
    pairs = [({"data": outcome}, m.fields) for (outcome, _), m in zip(ended, published, strict=False)]
    for number, (outcome, at) in enumerate(ended, start=1):
        if number > len(published):
            run.wrong_at(at, f"expected {outcome} on {OUTCOMES}, got nothing.", f"goal {number}", outcome, "nothing")
        message = published[number - 1]
        run.compare_at(at, f"goal {number}", "data", message.fields, {"data": outcome}, 0.0, OUTCOMES, pairs)
        late = round(message.at - at, 6)
        if abs(late) > 0.3:
            text = f"the outcome was expected when the goal had ended, got it {abs(late):.2f} s "
            text += "later." if late > 0 else "too early."
            run.wrong_at(message.at, text, f"goal {number}", "when it had ended", f"{late:.2f} s later")
    if len(published) > len(ended):
        text = f"{len(ended)} goals have ended: expected {len(ended)} outcomes, got {len(published)}."
        run.wrong_at(None, text, "", len(ended), len(published))


@check(
    points=3,
    hint="Where is send_goal_async() called?",
    todo="An ActionClient(self, MoveJoint, '/move_joint') in __init__, a MoveJoint.Goal, and send_goal_async(goal) "
    "are all that is needed. Log a line just before you send: does it appear, once for each target? If "
    "server_is_ready() is false, keep the target, and let the timer try again. Do not use send_goal(), which "
    "waits.",
    rule=("targets", "action"),
)
def test_sends_a_goal(succeeds: Run) -> None:
    """It sends a goal for /move_joint when a position arrives on /targets."""
    succeeds.must_have_interface("/targets", "/move_joint")
    succeeds.must_match_goals("position", tolerance=math.inf)


@check(
    points=5,
    hint="Which position does the goal hold when it is sent?",
    todo="The target is the field data of the message on /targets, in radians, as the goal's position is. Log both "
    "just before you send: are they the same? A MoveJoint.Goal that nobody fills in has the position 0.0.",
    depends=[test_sends_a_goal],
    rule="goal",
)
def test_goal_is_the_target(succeeds: Run) -> None:
    """The goal's position is the one that arrived on /targets."""
    succeeds.must_match_goals("position")


@check(
    points=12,
    hint="Which callback is called when the result is there, and what does it publish?",
    todo="A goal takes three steps, and each has a callback of its own. send_goal_async() returns a future: its "
    "callback gets the goal handle, and goal_handle.accepted says whether the server took the goal. "
    "get_result_async() of the handle returns the next future: its callback gets the result, when the goal "
    "has ended. future.result().status is a number, one of those in action_msgs.msg.GoalStatus. Make the word "
    "of the task from it, and publish that once. Log in each callback to see which one is not called.",
    depends=[test_sends_a_goal],
    rule=("outcome", "never_wait", "outcomes_topic"),
)
def test_publishes_the_outcome(succeeds: Run) -> None:
    """When the goal has succeeded, it publishes succeeded on /outcomes."""
    succeeds.must_have_interface(OUTCOMES)
    succeeds.must_publish(OUTCOMES)
    must_report_every_end(succeeds)


@check(
    points=8,
    hint="Which method gets the feedback, and which field of the message does it publish?",
    todo="send_goal_async() takes a second argument, feedback_callback: a method that is called with each "
    "feedback. Its message has the feedback inside: the position is message.feedback.position, because "
    "message itself also says to which goal it belongs. Make a Float64 of it and publish at once, each "
    "one, with no rounding and no comparison with the one before.",
    depends=[test_sends_a_goal],
    rule=("feedback", "never_wait", "progress_topic"),
    partial=True,
)
def test_publishes_progress(succeeds: Run) -> None:
    """It publishes each feedback on /progress."""
    succeeds.must_have_interface(PROGRESS)
    succeeds.must_match_series("data", PROGRESS, time=0.06)


@check(
    points=8,
    hint="Where do targets wait, which one is taken out next, and what sends it when a goal has ended?",
    todo="Put each target at the end of a list, and take the next one from its front, pop(0) or "
    "deque.popleft(). Something must send the next goal: call the method that sends in the callback of "
    "/targets, and again when a goal has ended, in whatever way. If only the timer sends, targets wait "
    "too long; if nothing but the callback of /targets sends, the last ones wait for ever.",
    depends=[test_goal_is_the_target],
    misconception="loses targets",
    rule=("order", "one", "goal", "never_wait"),
)
def test_every_target_in_order(several: Run) -> None:
    """Each of several targets becomes a goal, in the order in which they arrived."""
    several.must_match_goals("position")


@check(
    points=8,
    hint="How does your node know that a goal is under way, and when does it learn that it has ended?",
    todo="Keep in an attribute whether a goal is under way. It becomes true when you call send_goal_async(), "
    "not only when the server has accepted: a second target may arrive between the two. It becomes false "
    "when the result has arrived or the goal was rejected, and nowhere else. After that, send the next "
    "target at once.",
    depends=[test_sends_a_goal],
    misconception="several goals at once",
    rule=("one", "order", "never_wait"),
)
def test_one_goal_at_a_time(several: Run) -> None:
    """It sends the next goal when the one before has ended, not earlier and not much later."""
    goals = several.goals(by="node")
    if len(goals) < 2:
        several.wrong_at(
            None, "only one goal was sent: expected the next when it had ended.", "", "a next goal", "none"
        )
    for before, goal in itertools.pairwise(goals):
        last = before.states[-1] if before.states else None
        end = last.at if last and last.state in ENDS else goal.at + 1.0
        wait = round(goal.at - end, 6)
        if not 0.0 <= wait <= 0.25:
            text = f"goal {goal.number} was expected when goal {before.number} had ended, "
            text += "got it before that." if wait < 0 else f"got it {wait:.2f} s later."
            several.wrong_at(goal.at, text, "", "one goal at a time", "before the end" if wait < 0 else f"{wait:.2f} s")


@check(
    points=3,
    hint="super().__init__('joint_operator')",
    depends=[test_sends_a_goal],
    rule=("node", "other_topics"),
)
def test_node_is_called_joint_operator(succeeds: Run) -> None:
    """There is one node, it is called joint_operator, and it publishes on no other topics."""
    succeeds.must_have_nodes()
    succeeds.must_publish_on_no_others()


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_sends_a_goal],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(succeeds: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    succeeds.must_end_on_ctrl_c()
