"""The harder scenarios of `speed_limit`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

WANTED, SAFE = "/wanted_speed", "/safe_speed"
PUBLISHES = ["test_publishes_safe_speeds"]


@check(
    points=5,
    hint="Think of the cart that rolls backwards.",
    depends=PUBLISHES,
    misconception="limits only forwards",
    rule=("smaller", "safe"),
)
def test_too_fast_backwards(backwards: Run) -> None:
    """A speed below -1 m/s becomes -1 m/s."""
    backwards.must_match("data")


@check(
    points=3,
    hint="Use math.isnan(speed). No comparison with it is ever true.",
    depends=PUBLISHES,
    misconception="passes on what is not a number",
    rule=("not_a_number", "safe"),
)
def test_not_a_number(not_a_number: Run) -> None:
    """A speed that is not a number stops the cart."""
    not_a_number.must_match("data")


@check(
    points=2,
    hint="Check the names of the node and of its topics in __init__. Is a plain 10 the last argument of both?",
    depends=["test_safe_speeds_pass"],
    rule=("node", "ends"),
)
def test_node_is_as_described(gentle: Run) -> None:
    """It is called speed_limit, and has one subscription and one publisher, both reliable and volatile."""
    if gentle.nodes != ("/speed_limit",):
        fail("The node has another name.", expected="/speed_limit", got=", ".join(gentle.nodes))
    published = [end.topic for topic in gentle.topics("publisher") for end in gentle.publishers(topic)]
    if published != [SAFE]:
        fail("Your node's publishers.", expected=f"one, on {SAFE}", got=", ".join(published))
    for end in (*gentle.subscriptions(WANTED), *gentle.publishers(SAFE)):
        if (end.reliability, end.durability) != ("reliable", "volatile"):
            got = f"{end.reliability} and {end.durability}"
            fail(f"The {end.kind} on {end.topic} has another QoS.", expected="reliable and volatile", got=got)
