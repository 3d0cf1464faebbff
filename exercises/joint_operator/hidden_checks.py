"""The misbehaving servers of `joint_operator`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from checks import must_report_every_end

from grader.checking import Run, check, fail
from grader.recording.events import Goal

SENDS, OUTCOME = ["test_sends_a_goal"], ["test_publishes_the_outcome"]


def must_not_cancel(run: Run) -> None:
    """No goal of the student may be canceled."""
    for goal in run.goals(by="node"):
        for cancel in goal.cancels:
            text = "the goal had time left, but your node asked to cancel it."
            run.wrong_at(cancel.at, text, f"goal {goal.number}", "no request to cancel", "one")


def must_ask_to_cancel(run: Run, goal: Goal) -> None:
    """Fail unless the node asks to cancel this goal once, 5 s after it was accepted."""
    if len(goal.cancels) != 1:
        text = f"expected one request to cancel the goal that takes too long, got {len(goal.cancels)}."
        text += " Nothing keeps your node from asking again." if goal.cancels else ""
        run.wrong_at(goal.at, text, "", "one request", len(goal.cancels))
    after = round(goal.cancels[0].at - (goal.answered or goal.at), 6)
    if not 5.0 <= after <= 5.25:
        text = f"expected a request to cancel 5 s after the goal was accepted, got it after {after:.2f} s."
        run.wrong_at(goal.cancels[0].at, text, "", "5 s to 5.25 s", f"{after:.2f} s")


@check(
    points=5,
    hint="Put every message on /targets into the list, whatever its number is.",
    depends=["test_every_target_in_order"],
    misconception="loses targets",
    rule="goal",
)
def test_repeated_and_zero_targets(again: Run) -> None:
    """A target that is repeated, and one of 0.0, are goals like any other."""
    again.must_match_goals("position")


@check(
    points=7,
    hint="Look at goal_handle.accepted before you ask for a result. Then continue with the next target.",
    todo="A rejected goal has a goal handle, too, with accepted == False. It has no result: who waits for it "
    "waits for ever. So look at accepted first in the callback of send_goal_async(). If it is false, "
    "publish rejected, note that no goal is under way, and send the next target, as after any other end.",
    depends=SENDS,
    misconception="ignores accepted",
    rule=("outcome", "never_wait", "outcomes_topic"),
)
def test_rejected(rejects: Run) -> None:
    """When the server rejects a goal, it publishes rejected, and continues with the next."""
    rejects.must_match_goals("position")
    must_report_every_end(rejects)


@check(
    points=7,
    hint="future.result().status says how the goal ended.",
    todo="The result of get_result_async() has two parts: status says how the goal ended, result holds the "
    "position. Compare status with the constants of action_msgs.msg.GoalStatus: STATUS_SUCCEEDED, "
    "STATUS_ABORTED, STATUS_CANCELED. An aborted goal has a result as well, so the position says nothing "
    "about its success. Publish one outcome, and continue with the next target; do not try the same one "
    "again.",
    depends=OUTCOME,
    misconception="ignores the status",
    rule=("status", "outcomes_topic"),
)
def test_aborted(aborts: Run) -> None:
    """When the server aborts a goal, it publishes aborted, and continues with the next."""
    must_report_every_end(aborts)


@check(
    points=4,
    hint="Nothing has to happen until the server answers.",
    depends=OUTCOME,
    rule="outcome",
)
def test_server_that_answers_late(answers_late: Run) -> None:
    """When the server takes long to accept, it still waits for the result."""
    must_report_every_end(answers_late)


@check(
    points=6,
    hint="server_is_ready() says whether the server is there. Look again in the timer.",
    todo="server_is_ready() answers at once. Before you send, ask it, and return if it is false; the target "
    "stays in the list. A timer with a period of 0.1 s that calls the same method notices within 0.25 s "
    "that the server is there. Do not use wait_for_server(): it waits in a callback, and in __init__ it "
    "keeps the node from starting.",
    depends=SENDS,
    misconception="sends without a server",
    rule=("server", "never_wait"),
)
def test_server_appears_late(appears: Run) -> None:
    """When the server appears late, it sends all targets that were waiting."""
    goals = appears.goals(by="node")
    sent, expected = {goal.goal["position"] for goal in goals}, len(appears.sent)
    if len(sent) != expected:
        appears.wrong_at(None, f"expected {expected} goals, got {len(sent)}.", "", f"{expected} goals", len(sent))
    late = round(goals[0].at - 2.02, 6)
    if late > 0.25:
        text = f"the first goal was expected within 0.25 s after the server appeared, got it after {late:.2f} s."
        appears.wrong_at(goals[0].at, text, "", "within 0.25 s", f"{late:.2f} s")


@check(
    points=7,
    hint="Remember when the goal was accepted, and check the time in the timer.",
    todo="When the goal was accepted, keep its goal handle and the node's time in 5 s. In the timer, compare: "
    "if the time has come, call cancel_goal_async() on the goal handle, and forget the time, so that it "
    "is asked only once. Feedback changes nothing about the 5 s. When a goal ends, forget both, so that "
    "they do not count for the next goal.",
    depends=SENDS,
    misconception="waits forever",
    rule=("cancel", "clock"),
)
def test_asks_to_cancel(never_ends: Run, refuses_to_cancel: Run) -> None:
    """It asks to cancel a goal that takes longer than 5 s, once, even if there is feedback."""
    for run in (never_ends, refuses_to_cancel):
        must_ask_to_cancel(run, run.goals(by="node")[0])


@check(
    points=4,
    hint="A canceled goal has a result, too, with its own status.",
    todo="A request to cancel is only a request. The goal ends later, with a status of its own in the result, "
    "and that is what to publish. So asking for a cancel must change nothing else: the goal is still "
    "under way, its feedback still counts, and the next target waits until the result is there. The "
    "status 5 is STATUS_CANCELED; the outcome is spelled with one l.",
    depends=["test_publishes_the_outcome", "test_asks_to_cancel"],
    rule=("wait_on", "status"),
)
def test_canceled(never_ends: Run) -> None:
    """When the goal was canceled, it publishes canceled, and continues with the next; it can cancel again."""
    must_report_every_end(never_ends)
    for goal in never_ends.goals(by="node")[2:3]:
        must_ask_to_cancel(never_ends, goal)


@check(
    points=5,
    hint="The 5 s begin when the goal is accepted, and go by the node's clock.",
    todo="The 5 s begin when the server accepts the goal, in the callback of send_goal_async(), not when the "
    "target arrived or the goal was sent: the server may take a while. Use self.get_clock().now(), and "
    "set the time anew for every goal: one that is left over from the goal before comes too early for "
    "this one.",
    depends=["test_asks_to_cancel"],
    misconception="cancels too early",
    rule=("cancel", "clock"),
)
def test_waits_long_enough(slow: Run, late_and_slow: Run) -> None:
    """It does not cancel a goal that ends within 5 s after it was accepted."""
    for run in (slow, late_and_slow):
        must_not_cancel(run)


@check(
    points=4,
    hint="Publish an outcome only when the result has arrived, according to its status.",
    depends=["test_publishes_the_outcome", "test_asks_to_cancel"],
    misconception="believes that a cancel works",
    rule=("wait_on", "status"),
)
def test_cancel_that_does_not_work(refuses_to_cancel: Run, ignores_the_cancel: Run, aborts_late: Run) -> None:
    """What counts is how the goal ends, even if the server does not cancel it; until then there is feedback."""
    for run in (refuses_to_cancel, ignores_the_cancel, aborts_late):
        must_report_every_end(run)
    progress = [message.data for message in refuses_to_cancel.messages_on("/progress")][:3]
    if progress[:1] == [0.2] and progress != [0.2, 0.2, 0.6]:
        text = "the feedback was 0.2, 0.2 again, and 0.6 after the request to cancel: expected each on /progress, got "
        refuses_to_cancel.wrong_at(None, f"{text}{progress}.", "", "0.2, 0.2, 0.6", progress)


@check(
    points=1,
    hint="Create each end once, in __init__, with a plain 10.",
    depends=SENDS,
    rule="queue",
)
def test_quality_of_service(succeeds: Run) -> None:
    """All ends are reliable and volatile with a depth of 10, and there is one publisher on each topic."""
    succeeds.must_have_qos(depth=True)
    for topic in succeeds.exercise.outputs:
        count = len(succeeds.end_points("publisher", topic.name))
        if count != 1:
            fail(f"Publishers on {topic.name}.", expected=1, got=count)
