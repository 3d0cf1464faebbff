"""The harder scenarios of `joint_mover`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check

STEPS, SUCCEEDS = ["test_feedback_after_each_step"], ["test_succeeds"]


@check(
    points=5,
    hint="Keep the position in the node, not in the goal. A step can go down, too.",
    depends=STEPS,
    rule="The next goal starts where the joint is.",
)
def test_next_goal_starts_where_the_joint_is(down: Run) -> None:
    """The next goal starts where the joint is, and may be lower."""
    down.must_match_feedback("position", goal=2, time=0.05)


@check(
    points=4,
    hint="Without a step to take, the goal succeeds at once.",
    depends=SUCCEEDS,
    rule="If the joint is there already, no step is needed, and the goal succeeds at once.",
)
def test_already_there(there: Run) -> None:
    """A goal where the joint is already succeeds at once, without a step."""
    there.must_end("succeeded", goal=1, within=0.05)
    there.must_match_feedback("position", goal=1)


@check(
    points=4,
    hint="The limits themselves can be reached.",
    depends=["test_accepts_a_goal"],
    rule="Accept every goal between 0.0 rad and 2.356 rad, both included.",
)
def test_limits_are_accepted(limits: Run) -> None:
    """Goals at the limits are accepted."""
    limits.must_accept(1)
    limits.must_accept(2)


@check(
    points=4,
    hint="The last step is only as long as what is left.",
    depends=["test_limits_are_accepted", *SUCCEEDS, *STEPS],
    rule="the last one is shorter, and ends exactly at the goal.",
)
def test_reaches_the_limit(limits: Run) -> None:
    """It reaches the upper limit, and goes no further."""
    limits.must_end("succeeded", goal=1, within=4.85)
    limits.must_match_feedback("position", goal=1)


@check(
    points=5,
    hint="Compare with both limits in goal_callback.",
    depends=["test_accepts_a_goal"],
    misconception="accepts every goal",
    rule="Reject every other goal, and one that is not a number",
)
def test_out_of_reach_is_rejected(out_of_reach: Run) -> None:
    """Goals beyond the limits are rejected."""
    out_of_reach.must_reject(1)
    out_of_reach.must_reject(2)


@check(
    points=3,
    hint="Every comparison with nan is false.",
    depends=["test_accepts_a_goal"],
    rule="Reject every other goal, and one that is not a number",
)
def test_not_a_number_is_rejected(not_a_number: Run) -> None:
    """A goal that is not a number is rejected."""
    not_a_number.must_reject(1)


@check(
    points=4,
    hint="The result of a canceled goal says where the joint is then.",
    depends=["test_cancel", "test_result_is_the_position"],
    rule="The result holds the position where the joint stopped.",
)
def test_result_of_a_canceled_goal(canceled: Run) -> None:
    """The result of a canceled goal holds the position where the joint stopped."""
    canceled.must_match_results("position")


@check(
    points=3,
    hint="A canceled goal leaves the joint where it is.",
    depends=["test_cancel", *STEPS],
    rule="The next goal starts where the joint is.",
)
def test_goal_after_a_cancel(after_cancel: Run) -> None:
    """After a cancel the next goal starts where the joint stopped."""
    after_cancel.must_match_feedback("position", goal=2, time=0.05)


@check(
    points=4,
    hint="A new goal makes the old one end. Call abort(), because nobody asked to cancel it.",
    depends=SUCCEEDS,
    misconception="two goals at once",
    rule="The old one ends as aborted within 0.1 s, without another step of its own",
)
def test_second_goal_aborts_the_first(replaced: Run) -> None:
    """A second goal aborts the running goal within 0.1 s."""
    replaced.must_accept(2)
    replaced.must_end("aborted", goal=1, within=0.7)


@check(
    points=2,
    hint="Call abort(), and then return a result as always.",
    depends=["test_second_goal_aborts_the_first", "test_result_is_the_position"],
    misconception="canceled() without a request",
    rule="its result holds the position where it stopped.",
)
def test_result_of_a_replaced_goal(replaced: Run) -> None:
    """The result of a goal that was replaced holds the position where it stopped."""
    replaced.must_match_results("position")


@check(
    points=5,
    hint="Only the newest goal may move the joint.",
    depends=["test_second_goal_aborts_the_first", *STEPS],
    rule="The new one starts from there. Only one goal moves the joint.",
)
def test_second_goal_goes_on_from_there(replaced: Run, replaced_upwards: Run) -> None:
    """The second goal starts where the first one stopped."""
    for run in (replaced, replaced_upwards):
        run.must_match_feedback("position", goal=2, time=0.05)
        run.must_match_feedback("position", goal=1)


@check(
    points=3,
    hint="Look at goal_handle before you change anything: execute runs for accepted goals only.",
    depends=[*SUCCEEDS, "test_out_of_reach_is_rejected"],
    rule="Rejected goals change nothing: the running goal continues.",
)
def test_rejected_goal_changes_nothing(rejected_meanwhile: Run) -> None:
    """A rejected goal does not affect the running goal."""
    rejected_meanwhile.must_reject(2)
    rejected_meanwhile.must_end("succeeded", goal=1, within=1.0)
