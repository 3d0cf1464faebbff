"""What every student may read: the checks of `heartbeat`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the longer one.
"""

from __future__ import annotations

import itertools

from grader.checking import Run, check, fail


def must_be_regular(run: Run) -> None:
    """Fail unless each beat comes 0.25 s after the one before."""
    for number, (before, beat) in enumerate(itertools.pairwise(run.messages_on()), start=2):
        gap = (beat.at - before.at) / 1_000_000_000
        if abs(gap - 0.25) > 0.011:
            text = f"expected it 0.25 s after the beat before, got {gap:.3f} s."
            run.wrong_at(beat.at, text, f"beat {number}", "0.25 s", f"{gap:.3f} s")


@check(points=5, hint="Create the publisher and the timer in __init__, and call publish() in beat().")
def test_publishes_beats(start: Run) -> None:
    """It publishes Header messages on /heartbeat."""
    start.must_have_interface()
    start.must_publish()


@check(
    points=10,
    hint="A timer takes its period in seconds.",
    depends=[test_publishes_beats],
    misconception="rate and period mixed up",
)
def test_four_beats_a_second(start: Run) -> None:
    """It beats four times per second."""
    start.must_keep_rate(4.0)


@check(
    points=6,
    hint="Let a timer do it, and nothing else.",
    depends=[test_four_beats_a_second],
)
def test_each_beat_comes_in_time(start: Run) -> None:
    """Each beat comes 0.25 s after the one before."""
    must_be_regular(start)


@check(
    points=10,
    hint="Ask the node's clock again for each beat.",
    depends=[test_publishes_beats],
    misconception="another time in the stamp",
)
def test_stamp_is_the_time_of_the_beat(start: Run) -> None:
    """The stamp of a beat is the time of the node's clock."""
    start.must_stamp(field="stamp")


@check(points=5, hint="Set frame_id in each message.", depends=[test_publishes_beats])
def test_frame_is_torso(start: Run) -> None:
    """The frame of each beat is torso."""
    for number, beat in enumerate(start.messages_on(), start=1):
        if beat.fields["frame_id"] != "torso":
            got = beat.fields["frame_id"]
            start.wrong_at(beat.at, f'expected frame_id "torso", got "{got}".', f"beat {number}", "torso", got)


@check(points=2, hint="super().__init__('heartbeat')", depends=[test_publishes_beats])
def test_node_is_called_heartbeat(start: Run) -> None:
    """There is one node, it is called heartbeat, and it publishes on no other topics."""
    start.must_have_nodes()
    declared = {topic.name for topic in start.exercise.outputs}
    if others := sorted({end.topic for end in start.end_points("publisher")} - declared):
        fail("Your node publishes on other topics, too.", expected="none", got=", ".join(others))


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_publishes_beats],
)
def test_ends_on_ctrl_c(start: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    start.must_end_on_ctrl_c()
