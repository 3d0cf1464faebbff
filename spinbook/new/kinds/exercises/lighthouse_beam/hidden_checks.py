"""Checks that students may not read: the rest of `lighthouse_beam`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

PACE = ["test_five_messages_per_second"]


@check(
    points=1,
    hint="The header has a stamp and a frame.",
    depends=PACE,
    rule="header.frame_id is lighthouse.",
)
def test_frame_is_the_lighthouse(six_seconds: Run) -> None:
    """Each message has the frame of the lighthouse."""
    six_seconds.must_match_series("header.frame_id")


@check(
    points=3,
    hint="Is the timer's period exactly 0.2 s? Small errors add up.",
    depends=[*PACE, "test_beam_turns"],
    rule="After a minute the messages are as punctual as at the start.",
)
def test_punctual_after_a_minute(minute: Run) -> None:
    """After a minute, each message still arrives on time."""
    minute.must_match_series("vector", tolerance=1e-3, time=0.02)


@check(
    points=1,
    hint="Compare the names and the queue depths in __init__ with the task.",
    depends=PACE,
    rule="The node lighthouse_beam has one publisher, on /beam, and no other.",
)
def test_node_is_as_described(six_seconds: Run) -> None:
    """The node has the name and the quality of service of the task."""
    six_seconds.must_have_nodes()
    six_seconds.must_have_qos()
    if six_seconds.topics("publisher") != ["/beam"] or len(six_seconds.publishers("/beam")) > 1:
        topics = [end.topic for end in six_seconds.end_points("publisher")]
        fail("Your node has publishers that it should not have.", expected="/beam", got=", ".join(topics))
