"""The longer scenario of `heartbeat`. Every rule that it relies on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

PUBLISHES = ["test_publishes_beats"]


@check(
    points=4,
    hint="The timer must run for as long as the node runs.",
    depends=PUBLISHES,
    rule="It never stops and never drifts.",
)
def test_goes_on_for_a_minute(minute: Run) -> None:
    """It beats for a whole minute."""
    minute.must_have_no_gap(longest=5.0, end=60.1)


@check(
    points=3,
    hint="A timer keeps its rhythm by itself. Do not measure the time since the last beat.",
    depends=["test_each_beat_comes_in_time", "test_goes_on_for_a_minute"],
    rule="After a minute, the beats still come at quarters of a second.",
)
def test_does_not_drift(minute: Run) -> None:
    """The 240th beat is as punctual as the first."""
    beats = minute.messages_on()
    for number, beat in enumerate(beats):
        got, expected = (beat.at - beats[0].at) / 1_000_000_000, number * 0.25
        if abs(got - expected) > 0.011:
            text = f"expected it {expected:.2f} s after the first beat, got {got:.3f} s."
            minute.wrong_at(beat.at, text, f"beat {number + 1}", f"{expected:.2f} s", f"{got:.3f} s")


@check(
    points=1,
    hint="Create the publisher once, in __init__.",
    depends=PUBLISHES,
    rule="Create exactly one publisher on /heartbeat.",
)
def test_one_publisher(start: Run) -> None:
    """There is exactly one publisher on /heartbeat."""
    count = len(start.end_points("publisher", "/heartbeat"))
    if count != 1:
        fail("Publishers on /heartbeat.", expected=1, got=count)


@check(
    points=2,
    hint="Give create_publisher a plain 10.",
    depends=PUBLISHES,
    rule="A number alone makes it reliable and volatile.",
)
def test_quality_of_service(start: Run) -> None:
    """The publisher is reliable and volatile, as a queue depth alone makes it."""
    start.must_have_qos()
