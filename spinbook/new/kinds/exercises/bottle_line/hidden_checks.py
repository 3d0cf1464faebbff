"""Checks that students may not read: the rest of `bottle_line`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

SORTS = ["test_sorter_moves_the_gate"]

#: What each node publishes and subscribes to.
ENDS = (
    ("/bottle_scale", "publisher", "/full"),
    ("/bottle_scale", "subscription", "/weight"),
    ("/bottle_sorter", "publisher", "/gate"),
    ("/bottle_sorter", "subscription", "/full"),
)

#: What every node has.
OF_EVERY_NODE = {"publisher": ("/rosout", "/parameter_events"), "subscription": ("/clock", "/parameter_events")}


@check(
    points=3,
    hint="Use a timer of 2 s. Restart it with each message, and cancel it when it has fired.",
    depends=SORTS,
    misconception="never closes, or again and again",
    rule="since the last message on /full, it publishes closed, once.",
)
def test_gate_closes_when_the_scale_is_silent(pause: Run) -> None:
    """After 2 s without a bottle the gate closes, once, and the next bottle opens it again."""
    pause.must_match_series("data", topic="/gate", time=0.05)


@check(
    points=1,
    hint="The 2 s begin with a message on /full.",
    depends=SORTS,
    rule="Before the first message the gate is closed anyway: the sorter publishes nothing.",
)
def test_gate_without_a_bottle(nothing: Run) -> None:
    """Before the first bottle the sorter publishes nothing."""
    nothing.must_match_series("data", topic="/gate")


@check(
    points=2,
    hint="The sorter must not need the scale to run.",
    depends=["test_gate_closes_when_the_scale_is_silent"],
    rule="The next message on /full is answered as usual, and the 2 s start again with each.",
)
def test_scale_is_killed_and_comes_back(scale_ends: Run) -> None:
    """When the scale is killed, the gate closes. When the scale comes back, everything continues."""
    scale_ends.must_survive("bottle_sorter.py")
    scale_ends.must_match_series("data", topic="/gate", time=0.05)


@check(
    points=3,
    hint="Create subscriptions and publishers, and spin. Do not wait for anybody.",
    depends=["test_gate_closes_when_the_scale_is_silent"],
    misconception="waits for the other node",
    rule="Neither node waits for the other.",
)
def test_either_starts_late(scale_late: Run, sorter_late: Run) -> None:
    """Either node may start later than the other."""
    for run in (scale_late, sorter_late):
        run.must_survive()
        run.must_match_series("data", topic="/full")
        run.must_match_series("data", topic="/gate", time=0.05)


@check(
    points=1,
    hint="Compare the names and the queue depths in __init__ with the task.",
    depends=SORTS,
    rule="The nodes have these ends and no others: the sorter subscribes to the scale's topic, not to the weights.",
)
def test_node_is_as_described(line: Run) -> None:
    """The node has the name and the quality of service of the task."""
    line.must_have_nodes()
    line.must_have_qos()
    for node, kind, topic in ENDS:
        mine = [end for end in line.end_points(kind) if end.node == node and end.topic not in OF_EVERY_NODE[kind]]
        expected, got = f"{topic}, reliable", "; ".join(f"{end.topic}, {end.reliability}" for end in mine) or "none"
        if got != expected:
            fail(f"{node} has other {kind}s than in the task.", expected=expected, got=got)
