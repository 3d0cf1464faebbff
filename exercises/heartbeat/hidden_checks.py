"""The longer scenario of `heartbeat`. Every rule that it relies on is in task.md."""

from __future__ import annotations

import itertools
from statistics import median

from grader.checking import Run, check, fail

PUBLISHES = ["test_publishes_beats"]


@check(
    points=3,
    hint="The timer must run for as long as the node runs.",
    depends=PUBLISHES,
    rule="forever",
)
def test_goes_on_for_a_minute(minute: Run) -> None:
    """It beats for a whole minute and longer."""
    minute.must_publish()
    times = [beat.at for beat in minute.messages_on()]
    usual = median([after - before for before, after in itertools.pairwise(times)] or [0.25])
    minute.must_have_no_gap(longest=max(0.75, 3 * usual), end=70.1)


@check(
    points=3,
    hint="A timer keeps its rhythm by itself. Do not measure the time since the last beat.",
    depends=["test_four_beats_a_second", "test_goes_on_for_a_minute"],
    rule=("forever", "rate"),
)
def test_does_not_drift(minute: Run) -> None:
    """The 240th beat is as punctual as the first."""
    moments = sorted({beat.at for beat in minute.messages_on()})
    for number, at in enumerate(moments):
        got, expected = at - moments[0], number * 0.25
        if abs(got - expected) > 0.011:
            text = f"expected it {expected:.2f} s after the first beat, got {got:.3f} s."
            minute.wrong_at(at, text, f"beat {number + 1}", f"{expected:.2f} s", f"{got:.3f} s")


@check(
    points=1,
    hint="What beat() does must not depend on how often it was called.",
    depends=["test_stamp_is_the_time_of_the_beat"],
    rule=("stamp", "forever"),
)
def test_stamps_for_a_minute(minute: Run) -> None:
    """The stamps are still right after a minute."""
    minute.must_stamp(field="stamp")


@check(
    points=1,
    hint="What beat() does must not depend on how often it was called.",
    depends=["test_frame_is_torso"],
    rule=("frame", "forever"),
)
def test_frames_for_a_minute(minute: Run) -> None:
    """The frame is still torso after a minute."""
    for number, beat in enumerate(minute.messages_on(), start=1):
        if (got := beat.fields["frame_id"]) != "torso":
            minute.wrong_at(beat.at, f'expected frame_id "torso", got "{got}".', f"beat {number}", "torso", got)


@check(
    points=1,
    hint="Create the publisher once, in __init__.",
    depends=PUBLISHES,
    rule="one_publisher",
)
def test_one_publisher(start: Run) -> None:
    """There is exactly one publisher on /heartbeat."""
    count = len(start.end_points("publisher", "/heartbeat"))
    if count != 1:
        fail("Publishers on /heartbeat.", expected=1, got=count)


@check(
    points=1,
    hint="Give create_publisher a plain 10.",
    depends=PUBLISHES,
    rule="queue",
)
def test_quality_of_service(start: Run) -> None:
    """The publisher is reliable and volatile, as a queue depth alone makes it, and its depth is 10."""
    start.must_have_qos(depth=True)
