"""Checks that students may not read: the rest of `telescope_mount`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check

SERVES = ["test_feedback_after_each_step", "test_result_says_how_far_it_turned"]
IN_TURN = ["test_goals_one_after_another"]


def _must_serve(run: Run, *goals: int) -> None:
    """Each of these goals must succeed, with the solution's feedback and result."""
    for goal in goals:
        run.must_end("succeeded", goal=goal)
        run.must_match_feedback("remaining", goal=goal, tolerance=1e-4, time=0.05)
    run.must_match_results("delta", tolerance=1e-4)


@check(
    points=2,
    hint="Keep the angle from goal to goal.",
    depends=SERVES,
    rule="After a goal, however it ended, the telescope stays where it is, and the next goal begins there.",
)
def test_goals_one_after_another(in_turn: Run) -> None:
    """Each goal begins where the one before ended."""
    _must_serve(in_turn, 1, 2, 3)


@check(
    points=1,
    hint="Check whether there is anything to turn before the first step.",
    depends=IN_TURN,
    rule="If it pointed there from the start, the goal succeeds at once, without feedback.",
)
def test_a_goal_where_it_is(there: Run) -> None:
    """A goal to which it already points succeeds at once."""
    _must_serve(there, 1, 2, 3)


@check(
    points=1,
    hint="1.5 and -1.5 are goals like any other.",
    depends=IN_TURN,
    rule="A goal from −1.5 to 1.5 rad is accepted, if no other goal is being served.",
)
def test_goals_as_far_as_it_turns(edges: Run) -> None:
    """It turns as far as 1.5 rad to either side."""
    _must_serve(edges, 1, 2)


@check(
    points=1,
    hint="A goal callback returns GoalResponse.REJECT or GoalResponse.ACCEPT.",
    depends=SERVES,
    misconception="accepts every goal",
    rule="Every other goal is rejected: one that is too far, and one that comes while the telescope is turning.",
)
def test_goals_that_are_too_far(too_far: Run) -> None:
    """It rejects a goal that is too far, and serves the next one."""
    too_far.must_reject(1)
    too_far.must_reject(2)
    _must_serve(too_far, 3)


@check(
    points=2,
    hint="Remember in the goal callback that there is a goal, and forget it at the end of execute.",
    depends=IN_TURN,
    misconception="two goals at once",
    rule="Every other goal is rejected: one that is too far, and one that comes while the telescope is turning.",
)
def test_a_second_goal_while_one_is_served(busy: Run) -> None:
    """It rejects a goal that arrives while it is turning, and continues with the first."""
    busy.must_reject(2)
    _must_serve(busy, 1, 3)


@check(
    points=2,
    hint="Accept in a cancel callback, check is_cancel_requested after each wait, and call canceled().",
    depends=SERVES,
    misconception="ignores the request to cancel",
    rule="A request to cancel is accepted.",
)
def test_cancel(canceled: Run) -> None:
    """A goal that is canceled ends as canceled at the next step."""
    canceled.must_cancel(1, within=0.6)
    canceled.must_match_feedback("remaining", tolerance=1e-4)
    canceled.must_match_results("delta", tolerance=1e-4)


@check(
    points=1,
    hint="What you do at the end of execute must also happen after a cancel.",
    depends=["test_cancel", *IN_TURN],
    rule="After a goal, however it ended, the telescope stays where it is, and the next goal begins there.",
)
def test_a_goal_after_a_cancel(after_cancel: Run) -> None:
    """After a cancel the next goal begins where the telescope stopped."""
    _must_serve(after_cancel, 2)


@check(
    points=1,
    hint="Check the name that __init__ gives to the node.",
    depends=["test_serves_a_goal"],
    rule="Its node is called telescope_mount.",
)
def test_node_is_as_described(one_goal: Run) -> None:
    """The node has the name of the task."""
    one_goal.must_have_nodes()
    one_goal.must_have_interface(only=True)
