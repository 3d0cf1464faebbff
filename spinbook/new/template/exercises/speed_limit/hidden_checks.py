"""The harder scenarios of `speed_limit`. Every rule that they rely on is told in task.md."""

from __future__ import annotations

from grader.checking import Run, check

PUBLISHES = ["test_publishes_safe_speeds"]


@check(
    points=4,
    hint="Think of the cart that rolls backwards.",
    depends=PUBLISHES,
    misconception="limits only forwards",
    rule="A smaller speed, below −1 m/s, becomes −1 m/s.",
)
def test_too_fast_backwards(backwards: Run) -> None:
    """A speed below -1 m/s becomes -1 m/s."""
    backwards.must_match("data")


@check(
    points=2,
    hint="math.isnan(speed) tells. No comparison with it is ever true.",
    depends=PUBLISHES,
    misconception="passes on what is not a number",
    rule="A speed that is not a number (math.isnan(speed) is true) becomes 0 m/s: the cart stops.",
)
def test_not_a_number(not_a_number: Run) -> None:
    """A speed that is not a number stops the cart."""
    not_a_number.must_match("data")


@check(
    points=2,
    hint="Keep the callback short; never sleep in it.",
    depends=["test_too_fast_is_slowed_down"],
    rule="Answer from the callback, so that each answer goes out before the next message is handled.",
)
def test_burst(burst: Run) -> None:
    """Each of 100 messages in 0.1 s gets its answer."""
    burst.must_answer()
