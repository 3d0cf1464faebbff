"""The harder scenarios of `joint_mover`. Every rule that they rely on is in task.md."""

from __future__ import annotations

import itertools

from grader.checking import Run, check

ACCEPTS, STEPS = ["test_accepts_a_goal"], ["test_feedback_after_each_step"]


@check(
    points=5,
    hint="Where does the second goal start, and does its position say where to go, or how far? A step can go down.",
    todo="The joint exists once, so its position belongs to the node: set it in __init__, and let each step "
    "change it. A local variable in execute that begins at 0.0 makes the joint jump back with each goal. "
    "A goal may be lower than the position: then each step is -0.05, and a loop with `while position < "
    "goal` never runs.",
    depends=STEPS,
    rule=("next", "feedback", "steps", "last", "start"),
)
def test_next_goal_starts_where_the_joint_is(down: Run) -> None:
    """The next goal starts where the joint is, and may be lower."""
    down.must_match_feedback("position", goal=2, time=0.05)


@check(
    points=4,
    hint="Without a step to take, the goal succeeds at once.",
    depends=ACCEPTS,
    rule=("there", "start"),
)
def test_already_there(there: Run) -> None:
    """A goal where the joint is already succeeds at once, without a step."""
    there.must_end("succeeded", goal=1, within=0.05)
    there.must_match_feedback("position", goal=1)


@check(
    points=4,
    hint="The limits themselves can be reached.",
    depends=ACCEPTS,
    rule=("accept", "meanwhile"),
)
def test_limits_are_accepted(limits: Run) -> None:
    """Goals at the limits are accepted."""
    limits.must_accept(1)
    limits.must_accept(2)


@check(
    points=4,
    hint="The last step is only as long as what is left.",
    depends=STEPS,
    rule=("last", "feedback", "steps", "start"),
)
def test_reaches_the_limit(limits: Run) -> None:
    """It reaches the upper limit, and goes no further."""
    limits.must_end("succeeded", goal=1)
    limits.must_match_feedback("position", goal=1)


@check(
    points=5,
    hint="Compare with both limits in goal_callback.",
    todo="Compare with both limits, and combine the two: a position is allowed if it is at least the lower and "
    "at most the upper one. Log the goal and the answer in the goal callback. Without a goal_callback, "
    "ActionServer accepts everything; and a goal that execute aborts was accepted before, which the "
    "client sees.",
    depends=ACCEPTS,
    misconception="accepts every goal",
    rule="reject",
)
def test_out_of_reach_is_rejected(out_of_reach: Run) -> None:
    """Goals beyond the limits are rejected."""
    out_of_reach.must_reject(1)
    out_of_reach.must_reject(2)


@check(
    points=3,
    hint="Every comparison with nan is false.",
    depends=ACCEPTS,
    rule="reject",
)
def test_not_a_number_is_rejected(not_a_number: Run) -> None:
    """A goal that is not a number, or infinite, is rejected."""
    not_a_number.must_reject(1)
    not_a_number.must_reject(2)


@check(
    points=4,
    hint="The result of a canceled goal says where the joint is then.",
    depends=["test_cancel", "test_result_is_the_position"],
    rule=("cancel_result", "cancel", "at_goal", "clock"),
)
def test_result_of_a_canceled_goal(canceled: Run) -> None:
    """The result of a canceled goal holds the position where the joint stopped."""
    canceled.must_match_results("position")


@check(
    points=3,
    hint="A canceled goal leaves the joint where it is.",
    depends=["test_cancel", *STEPS],
    rule=("next", "cancel", "feedback", "steps", "last", "start", "cancel_result"),
)
def test_goal_after_a_cancel(after_cancel: Run) -> None:
    """After a cancel the next goal starts where the joint stopped."""
    after_cancel.must_match_feedback("position", goal=2, time=0.05)


@check(
    points=4,
    hint="A new goal makes the old one end. Call abort(), because nobody asked to cancel it.",
    todo="Let the node remember which goal handle is the newest, for example in execute's first line. Each "
    "execute compares it with its own before each step: if they differ, another goal has come, so it "
    "calls abort() and returns a Result with the position. It is aborted, not canceled, because nobody "
    "has asked for a cancel. Both executes must be able to run at once for this.",
    depends=ACCEPTS,
    misconception="two goals at once",
    rule=("replace", "meanwhile"),
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
    rule=("replace", "at_goal", "clock"),
)
def test_result_of_a_replaced_goal(replaced: Run) -> None:
    """The result of a goal that was replaced holds the position where it stopped."""
    replaced.must_match_results("position")


@check(
    points=5,
    hint="Only the newest goal may move the joint.",
    todo="For a moment two executes run. The old one must not move the joint any more once the new one has "
    "begun: check which goal is the newest just before each step, after the wait and not before it. Both "
    "use the position of the node. Neither keeps a copy of it over a wait, or it takes back what the "
    "other has done.",
    depends=["test_second_goal_aborts_the_first", *STEPS],
    rule=("one_moves", "next", "feedback", "steps", "last", "start"),
)
def test_second_goal_goes_on_from_there(replaced: Run, replaced_upwards: Run) -> None:
    """The second goal starts where the first one stopped."""
    for run in (replaced, replaced_upwards):
        run.must_match_feedback("position", goal=2, time=0.05)
        run.must_match_feedback("position", goal=1)


@check(
    points=3,
    hint="Look at goal_handle before you change anything: execute runs for accepted goals only.",
    depends=["test_out_of_reach_is_rejected"],
    rule="rejected",
)
def test_rejected_goal_changes_nothing(rejected_meanwhile: Run) -> None:
    """A rejected goal does not affect the running goal."""
    rejected_meanwhile.must_reject(2)
    goal = rejected_meanwhile.goal(1)
    rejected = rejected_meanwhile.goal(2).at
    last = max((feedback.at for feedback in goal.feedback), default=None)
    ends = [
        state.at for state in goal.states if state.state in ("aborted", "canceled") and state.at < rejected + 0.2999
    ]
    if ends or (last is not None and last < rejected):
        text = "the running goal was expected to continue, got its end."
        rejected_meanwhile.wrong_at(rejected, text, "goal 1", "to continue", "an end")
    positions = [feedback.fields["position"] for feedback in goal.feedback]
    for before, now in itertools.pairwise(positions):
        if now < before:
            text = f"the running goal was expected to continue upwards, got {now:.3g} rad after {before:.3g} rad."
            rejected_meanwhile.wrong_at(rejected, text, "goal 1", "to continue", f"{now:.3g} rad")
