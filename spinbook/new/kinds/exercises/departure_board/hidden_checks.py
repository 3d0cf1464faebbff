"""Checks that students may not read: the rest of `departure_board`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check

SHOWS = ["test_shows_destination_and_delay"]


@check(
    points=3,
    hint="Compare each delay with the one before.",
    depends=SHOWS,
    rule="A delay that differs from the one before is shown with one message. The same delay again is not.",
)
def test_shows_each_change_once(delays: Run) -> None:
    """Each delay that differs from the one before is shown once; without a delay the line is the destination."""
    delays.must_match_series("data")


@check(
    points=2,
    hint="The depth says how many messages are kept for late subscribers.",
    depends=["test_shows_each_change_once", "test_a_late_passenger_sees_the_line"],
    misconception="keeps old messages",
    rule="Late subscribers get the current line, and no older one.",
)
def test_a_late_passenger_sees_no_older_line(delays: Run) -> None:
    """Late subscribers get the latest line and nothing else."""
    delays.must_match_series("data", subscriber="latest")


@check(
    points=2,
    hint="A volatile subscription misses what was published before it was there.",
    depends=SHOWS,
    misconception="volatile where transient local is needed",
    rule="A destination is published rarely, maybe before your node starts.",
)
def test_a_destination_from_before_the_start(early: Run) -> None:
    """A destination that was published before the node started is shown."""
    early.must_match_series("data")


@check(
    points=2,
    hint="Remember each delay, and show it as soon as there is a destination. Show each destination.",
    depends=SHOWS,
    rule="A delay that arrives then is remembered.",
)
def test_a_delay_before_there_is_a_destination(delay_first: Run) -> None:
    """A delay from before the first destination is remembered, and each destination is shown."""
    delay_first.must_match_series("data")


@check(
    points=1,
    hint="Compare the three ends with the table, column by column.",
    depends=SHOWS,
    rule="QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL) is the quality of service of two of them.",
)
def test_ends_are_as_described(one_train: Run) -> None:
    """The node has the name, and its three ends have the quality of service of the task."""
    one_train.must_have_nodes()
    one_train.must_have_interface(only=True)
    one_train.must_have_qos()
