"""What every student may read: the checks of `heartbeat`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the longer one.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

from grader.checking import Run, Wrong, check, each
from grader.recording.recording import ReceivedMessage


def without_doubles(run: Run) -> Run:
    """Return the run with one message for each moment. Whether a beat comes twice is judged by one check alone."""
    received = run.recording.received
    moments = [beat.at_ns for beat in received]
    first = tuple(beat for number, beat in enumerate(received) if beat.at_ns not in moments[:number])
    return replace(run, recording=replace(run.recording, received=first))


def must_be_regular(run: Run) -> None:
    """Fail unless each beat comes 0.25 s after the one before."""

    def judge(numbered: tuple[int, tuple[ReceivedMessage, ReceivedMessage]]) -> None:
        number, (before, beat) = numbered
        gap = beat.at - before.at
        if abs(gap - 0.25) > 0.011:
            text = f"expected it 0.25 s after the beat before, got {gap:.3f} s."
            run.wrong_at(beat.at, text, f"beat {number}", "0.25 s", f"{gap:.3f} s")

    each(enumerate(itertools.pairwise(run.messages_on()), start=2), judge)


def must_have_the_frame(run: Run) -> None:
    """Fail unless the frame of each beat is torso."""

    def judge(numbered: tuple[int, ReceivedMessage]) -> None:
        number, beat = numbered
        if (got := beat.fields["frame_id"]) != "torso":
            run.wrong_at(beat.at, f'expected frame_id "torso", got "{got}".', f"beat {number}", "torso", got)

    each(enumerate(run.messages_on(), start=1), judge)


@check(
    points=5,
    hint="Which fields of the message does beat() fill in before it calls publish()?",
    todo="beat() is called once for each beat. It makes a new Header, fills in both fields, and publishes it. "
    "stamp is the time of the node's clock at this moment, as a message: the Time that now() returns has "
    "to_msg() for that. frame_id is a text: the name of the frame in the task, in the same letters. Look at "
    "one beat with `ros2 topic echo /heartbeat`: is the stamp another one in each beat, and is the frame the "
    "right one?",
    rule="topic",
)
def test_publishes_beats(start: Run) -> None:
    """It publishes Header messages on /heartbeat, and the stamp or the frame of most is right."""
    start.must_have_interface()
    start.must_publish()
    try:
        start.must_stamp(field="stamp")
    except Wrong as wrong:
        if wrong.share <= 0.5:
            must_have_the_frame(start)


@check(
    points=8,
    hint="A timer takes its period in seconds.",
    todo="create_timer(period, callback) takes the time between two calls in seconds. Four per second means "
    "one every quarter of a second. The timer must be the only thing that decides when a beat comes: no "
    "time.sleep(), which goes by the computer's clock, no loop, no threading.Timer. main() must call "
    "rclpy.spin(node), because the timer only fires while the node spins. `ros2 topic hz /heartbeat` "
    "shows the rate.",
    depends=[test_publishes_beats],
    misconception="rate and period mixed up",
    rule=("rate", "clock"),
)
def test_four_beats_a_second(start: Run) -> None:
    """It beats four times per second."""
    without_doubles(start).must_keep_rate(4.0)


@check(
    points=5,
    hint="What decides when the next beat comes? Only a timer with the right period keeps time.",
    todo="create_timer(period, method) in __init__ calls the method again and again, by the node's clock, and "
    "rclpy.spin() keeps it running. The period is the time from one call to the next, in seconds: one divided "
    "by the rate. Do not publish anywhere else, do not create the timer again in beat(), and do not wait in "
    "beat(): a beat that waits delays the next one. `ros2 topic hz /heartbeat` shows the rate of a node that "
    "runs.",
    depends=[test_publishes_beats],
    rule=("rate", "clock"),
)
def test_each_beat_comes_in_time(start: Run) -> None:
    """Each beat comes 0.25 s after the one before."""
    must_be_regular(without_doubles(start))


@check(
    points=2,
    hint="Create the timer in __init__.",
    depends=[test_publishes_beats],
    rule="rate",
)
def test_beats_from_the_start(start: Run) -> None:
    """The first beat comes within the first quarter of a second."""
    first = start.messages_on()[0].at
    if first > 0.261:
        text = f"the first beat was expected within 0.25 s after the start, got it after {first:.2f} s."
        start.wrong_at(start.messages_on()[0].at, text, "beat 1", "within 0.25 s", f"after {first:.2f} s")


@check(points=3, hint="One timer, one publish().", depends=[test_publishes_beats], rule="once")
def test_one_message_for_each_beat(start: Run) -> None:
    """Each beat is one message."""
    for number, (before, beat) in enumerate(itertools.pairwise(start.messages_on()), start=2):
        if beat.at - before.at < 0.0099:
            text = "it comes together with the beat before: expected one message."
            start.wrong_at(beat.at, text, f"message {number}", "one message", "two")


@check(
    points=9,
    hint="Ask the node's clock again for each beat.",
    todo="self.get_clock().now() is the time of the node's clock, and to_msg() makes the stamp of it, with "
    "both of its fields: whole seconds, and the rest in nanoseconds. Call both in beat(), for each beat, "
    "just before you publish. A stamp that __init__ has made stays the time of the start. time.time() and "
    "datetime are the computer's clock, which says another time than the robot's.",
    depends=[test_publishes_beats],
    misconception="another time in the stamp",
    rule=("stamp", "clock"),
    partial=True,
)
def test_stamp_is_the_time_of_the_beat(start: Run) -> None:
    """The stamp of a beat is the time of the node's clock."""
    start.must_stamp(field="stamp")


@check(
    points=4,
    hint="Set frame_id in each message.",
    todo="frame_id is a field of the Header itself: message.frame_id. Set it for each message, before "
    "publish(): what you change afterwards is not sent. The text is exactly the one in the task: small "
    "letters, no slash before it, no spaces, and not the name of the node. A new Header() has an empty "
    "text.",
    depends=[test_publishes_beats],
    rule="frame",
    partial=True,
)
def test_frame_is_torso(start: Run) -> None:
    """The frame of each beat is torso."""
    must_have_the_frame(start)


@check(points=2, hint="super().__init__('heartbeat')", depends=[test_publishes_beats], rule=("node", "other_topics"))
def test_node_is_called_heartbeat(start: Run) -> None:
    """There is one node, it is called heartbeat, and it publishes on no other topics."""
    start.must_have_nodes()
    start.must_publish_on_no_others()


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_publishes_beats],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(start: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    start.must_end_on_ctrl_c()
