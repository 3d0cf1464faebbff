"""What students may not read: the rest of `lighthouse_beam`. Every rule that is relied on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

TURNS = ["test_five_messages_per_second", "test_beam_turns"]


@check(
    points=1,
    hint="The header has a stamp and a frame.",
    depends=["test_five_messages_per_second"],
    rule="header.frame_id is lighthouse.",
)
def test_frame_is_the_lighthouse(six_seconds: Run) -> None:
    """Each message has the frame of the lighthouse."""
    six_seconds.must_match_series("header.frame_id")


@check(
    points=3,
    hint="Is the timer's period exactly 0.2 s? What is lost with each message adds up.",
    depends=TURNS,
    rule="After a minute the messages are as punctual as at the start.",
)
def test_punctual_after_a_minute(minute: Run) -> None:
    """After a minute each message still comes at its time."""
    minute.must_match_series("vector", tolerance=1e-3, time=0.02)


@check(
    points=1,
    hint="Look at the names in __init__: of the node, of its topic. Is a plain 10 the last argument?",
    depends=["test_publishes_the_beam"],
    rule="The node lighthouse_beam has one publisher, on /beam, and no other.",
)
def test_node_is_as_described(six_seconds: Run) -> None:
    """It is called lighthouse_beam, and has one publisher, which is reliable and volatile."""
    if six_seconds.nodes != ("/lighthouse_beam",):
        fail("The node has another name.", expected="/lighthouse_beam", got=", ".join(six_seconds.nodes))
    ends = [end for topic in six_seconds.topics("publisher") for end in six_seconds.publishers(topic)]
    if [end.topic for end in ends] != ["/beam"]:
        fail("Your node's publishers.", expected="one, on /beam", got=", ".join(end.topic for end in ends))
    if (ends[0].reliability, ends[0].durability) != ("reliable", "volatile"):
        got = f"{ends[0].reliability} and {ends[0].durability}"
        fail("The publisher has another QoS.", expected="reliable and volatile", got=got)
