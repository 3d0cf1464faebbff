"""The misbehaving servers of `joint_operator`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

OUTCOMES = "/outcomes"
OUTCOME, ORDER = ["test_publishes_the_outcome"], ["test_every_target_in_order"]


def outcomes(run: Run) -> None:
    """The outcomes must be the solution's, and about when it publishes them."""
    run.must_match_series("data", OUTCOMES, time=0.3)


def must_not_cancel(run: Run) -> None:
    """No goal of the student may be canceled."""
    for goal in run.goals(by="node"):
        for cancel in goal.cancels:
            text = "the goal had time left, but your node asked to cancel it."
            run.wrong_at(cancel.at, text, f"goal {goal.number}", "no request to cancel", "one")


@check(
    points=8,
    hint="Look at goal_handle.accepted before you ask for a result. Then continue with the next target.",
    depends=ORDER,
    misconception="ignores accepted",
    rule="or rejected if the server did not accept it.",
)
def test_rejected(rejects: Run) -> None:
    """When the server rejects a goal, it publishes rejected, and continues with the next."""
    outcomes(rejects)


@check(
    points=7,
    hint="future.result().status says how the goal ended.",
    depends=ORDER,
    misconception="ignores the status",
    rule="What counts is the status that comes with the result, not what you asked for.",
)
def test_aborted(aborts: Run) -> None:
    """When the server aborts a goal, it publishes aborted, and continues with the next."""
    outcomes(aborts)


@check(
    points=4,
    hint="Nothing has to happen until the server answers.",
    depends=OUTCOME,
    rule="is published on /outcomes when its goal has ended",
)
def test_server_that_answers_late(answers_late: Run) -> None:
    """When the server takes long to accept, it still waits for the result."""
    outcomes(answers_late)


@check(
    points=7,
    hint="server_is_ready() says whether the server is there. Look again in the timer.",
    depends=ORDER,
    misconception="sends without a server",
    rule="Keep the targets, and send the first one within 0.25 s after the server appears.",
)
def test_server_appears_late(appears: Run) -> None:
    """When the server appears late, it sends all targets that were waiting."""
    appears.must_match_goals("position")
    first = appears.goals(by="node")[0]
    late = (first.at - 102_020_000_000) / 1_000_000_000
    if late > 0.25:
        text = f"the first goal was expected within 0.25 s after the server appeared, got it after {late:.2f} s."
        appears.wrong_at(first.at, text, "", "within 0.25 s", f"{late:.2f} s")


@check(
    points=7,
    hint="Remember when the goal was accepted, and check the time in the timer.",
    depends=OUTCOME,
    misconception="waits forever",
    rule="If a goal has not ended 5 s after it was accepted, ask the server to cancel it, once, within 0.25 s.",
)
def test_asks_to_cancel(never_ends: Run) -> None:
    """It asks to cancel a goal that takes longer than 5 s, once."""
    first = never_ends.goals(by="node")[0]
    if len(first.cancels) != 1:
        text = f"expected one request to cancel the goal that never ends, got {len(first.cancels)}."
        never_ends.wrong_at(first.at, text, "", "one request", len(first.cancels))
    after = (first.cancels[0].at - (first.answered or first.at)) / 1_000_000_000
    if not 5.0 <= after <= 5.25:
        text = f"expected a request to cancel 5 s after the goal was accepted, got it after {after:.2f} s."
        never_ends.wrong_at(first.cancels[0].at, text, "", "5 s to 5.25 s", f"{after:.2f} s")


@check(
    points=5,
    hint="A canceled goal has a result, too, with its own status.",
    depends=["test_asks_to_cancel", *ORDER],
    rule="Then continue to wait for its result",
)
def test_canceled(never_ends: Run) -> None:
    """When the goal was canceled, it publishes canceled, and continues with the next."""
    outcomes(never_ends)


@check(
    points=5,
    hint="The 5 s begin when the goal is accepted, and go by the node's clock.",
    depends=OUTCOME,
    misconception="cancels too early",
    rule="If a goal has not ended 5 s after it was accepted, ask the server to cancel it",
)
def test_waits_long_enough(slow: Run, late_and_slow: Run) -> None:
    """It does not cancel a goal that ends within 5 s after it was accepted."""
    for run in (slow, late_and_slow):
        must_not_cancel(run)


@check(
    points=5,
    hint="Publish an outcome only when the result has arrived, according to its status.",
    depends=["test_asks_to_cancel", *ORDER],
    misconception="believes that a cancel works",
    rule="the server may refuse to cancel it, and it may even succeed.",
)
def test_cancel_that_does_not_work(refuses_to_cancel: Run, ignores_the_cancel: Run, aborts_late: Run) -> None:
    """What counts is how the goal ends, even if the server does not cancel it."""
    for run in (refuses_to_cancel, ignores_the_cancel, aborts_late):
        outcomes(run)


@check(
    points=2,
    hint="Create each end once, in __init__, with a plain 10.",
    depends=["test_sends_a_goal"],
    rule="Use a queue depth of 10 for all topics.",
)
def test_quality_of_service(succeeds: Run) -> None:
    """All ends are reliable and volatile, and there is one publisher on each topic."""
    succeeds.must_have_qos()
    for topic in succeeds.exercise.outputs:
        count = len(succeeds.end_points("publisher", topic.name))
        if count != 1:
            fail(f"Publishers on {topic.name}.", expected=1, got=count)
