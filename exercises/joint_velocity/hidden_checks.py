"""The harder scenarios of `joint_velocity`. Every rule that they rely on is in task.md."""

from __future__ import annotations

import itertools

from grader.checking import Run, check, fail

COMMANDS, VELOCITIES, CLOCK = "/joint_commands", "/joint_velocities", "/clock"

PUBLISHES = ["test_publishes_velocities"]
VELOCITY = ["test_velocity_of_each_joint"]


def must_name_the_right_joints(run: Run) -> None:
    """Fail unless each answer is about the joints that have a velocity. The order and the numbers do not count.

    Only a message that is answered about other joints than usual must be answered.
    """
    usual = max((set(ex.expected[0].name) for ex in run if ex.expected), key=len)
    for exchange in list(run)[1:]:
        if exchange.expected and not exchange.answers and set(exchange.expected[0].name) != usual:
            run.wrong(exchange, "an answer was expected, got none.", "", "a message", "nothing")
        for answer in exchange.answers:
            expected = set(exchange.expected[0].name) if exchange.expected else set()
            got = set(answer.name)
            if got != expected:
                wrong = sorted(got ^ expected)[0]
                text = "it was not expected in this message." if wrong in got else "it was expected in this message."
                run.wrong(exchange, text, wrong, ", ".join(sorted(expected)), ", ".join(sorted(got)))


def must_answer_late_ones(run: Run, seconds: float) -> None:
    """Fail unless at least half of the messages more than `seconds` after the previous one are answered."""
    late = [now for before, now in itertools.pairwise(run) if now.sent.stamp - before.sent.stamp > seconds]
    if 2 * sum(bool(exchange.answers) for exchange in late) < len(late):
        run.wrong(late[0], "an answer was expected, got none.", "", "a message", "nothing")


def must_be_silent_and_go_on(run: Run) -> None:
    """Fail unless nothing is published where nothing is expected, and something after that."""
    run.must_be_silent()
    last = list(run)[-3:]
    if not any(exchange.answers for exchange in last):
        run.wrong(last[-1], "an answer was expected, got none.", "", "a message", "nothing")


@check(
    points=4,
    hint="dt is not always 0.1 s. Take it from the stamps.",
    depends=VELOCITY,
    misconception="fixed dt",
    rule=("dt", "velocity", "before", "in_both", "both_parts", "velocities"),
)
def test_speed_that_never_changes(steady: Run) -> None:
    """A joint that moves at a constant speed has that velocity, whenever the messages arrive."""
    speeds = {"left_elbow": 0.25, "right_elbow": -1.5, "left_shoulder_pitch": 0.0}
    for exchange in list(steady)[1:]:
        for answer in exchange.answers:
            for joint, velocity in answer.by("name", "velocity").items():
                speed = speeds.get(joint, 0.0)
                if abs(velocity - speed) > 1e-6 * max(1.0, abs(speed)):
                    text = f"expected velocity {speed:g} rad/s, got {velocity:.9g} rad/s."
                    steady.wrong(exchange, text, joint, f"{speed:g}", f"{velocity:.9g}")
    steady.must_match("velocity", per="name", missing_ok=True)


@check(
    points=5,
    hint="A message may arrive late. Its stamp says when it was true, the clock only when it arrived.",
    todo="A message takes time to arrive. Its stamp says when the positions were measured, and only that "
    "matters for a velocity. Do not use self.get_clock().now() or the time at which the callback runs in "
    "the formula: take both times from the headers of the two messages.",
    depends=VELOCITY,
    misconception="time of arrival for the stamp",
    rule=("dt", "velocity", "before", "clock", "both_parts", "velocities"),
)
def test_late_messages(delayed: Run) -> None:
    """Velocities are right when messages arrive later than their stamps say."""
    delayed.must_match("velocity", per="name", missing_ok=True)


@check(
    points=2,
    hint="Copy the header as a whole. The node's clock says when the message arrived, not when it was true.",
    depends=["test_stamp_is_copied"],
    misconception="time of arrival for the stamp",
    rule="header",
)
def test_stamp_of_late_messages(delayed: Run) -> None:
    """The stamp is that of the message that arrived, even if it arrived late."""
    delayed.must_match("header.stamp", missing_ok=True)


@check(
    points=2,
    hint="Copy the header as a whole: it holds the stamp and the frame.",
    depends=PUBLISHES,
    rule="header",
)
def test_frame_is_copied(delayed: Run) -> None:
    """The frame is that of the message that arrived, even if it changes."""
    delayed.must_match("header.frame_id", missing_ok=True)


@check(
    points=4,
    hint="Neither time.time() nor the node's clock: only the stamps tell the time.",
    todo="Your node got the same messages twice, at another pace of the computer, and gave different answers. "
    "Something in the formula comes from the computer: time.time(), time.monotonic(), datetime.now(), or "
    "a random number. Take both times from the stamps of the two messages, and nothing else.",
    depends=PUBLISHES,
    misconception="wall clock",
    rule="clock",
)
def test_same_messages_same_answers(irregular: Run, irregular_again: Run) -> None:
    """The same messages get the same answers: it does not read the computer's clock."""
    for once, again in zip(irregular, irregular_again, strict=True):
        for first, second in zip(once.answers, again.answers, strict=False):
            for joint, velocity in first.by("name", "velocity").items():
                other = second.by("name", "velocity").get(joint)
                if other is not None and velocity != other and not (velocity != velocity and other != other):
                    text = "the same messages got a different velocity when they were sent a second time."
                    irregular.wrong(once, text, joint, "the same velocity twice", "two velocities")


@check(
    points=5,
    hint="The stamps give the time since the last message that arrived.",
    todo="A message that is lost is one that the callback never sees. Nothing has to be detected: the message "
    "before is simply the last one that arrived, and its stamp is 0.2 s ago rather than 0.1 s. If your "
    "velocities are twice too large there, the time is a constant. If an answer is missing, look for a "
    "condition that expects a certain time between messages.",
    depends=VELOCITY,
    rule=("lost", "dt", "velocity", "before", "both_parts", "velocities"),
)
def test_lost_messages(lossy: Run) -> None:
    """Velocities are right when messages are lost."""
    must_answer_late_ones(lossy, 0.15)
    lossy.must_match("velocity", per="name", missing_ok=True)


@check(
    points=6,
    hint="Remember positions by name, not by index in the list.",
    todo="position[0] may be the elbow now and the shoulder next time. Make a dictionary of each message, from "
    "the joint's name to its position, with dict(zip(message.name, message.position)). Look up each joint "
    "of this message in the dictionary of the message before. An index, or zip() over the positions of "
    "two messages, compares different joints.",
    depends=VELOCITY,
    misconception="joints by index",
    rule=("by_name", "velocity"),
)
def test_joints_in_another_order(reordered: Run) -> None:
    """Velocities are right when the joints are in another order in each message."""
    reordered.must_match("velocity", per="name", missing_ok=True)


@check(
    points=2,
    hint="Take the names from the message that arrived, not from the one before or from a list of your own.",
    depends=["test_names_in_the_order_of_the_message", *VELOCITY],
    misconception="names in the order of another message",
    rule="names",
)
def test_names_in_another_order(reordered: Run) -> None:
    """The joints' names are in the order of the message that arrived, even if the order changes."""
    reordered.must_match("name", missing_ok=True)


@check(
    points=2,
    hint="Leave out a joint that the message just before did not have.",
    depends=PUBLISHES,
    rule=("new", "in_both"),
)
def test_new_joint(new_joint: Run) -> None:
    """A joint that is new is left out once."""
    must_name_the_right_joints(new_joint)


@check(
    points=2,
    hint="Compare with the message just before, and with no older one.",
    depends=PUBLISHES,
    misconception="remembers joints that were missing",
    rule=("missing", "in_both", "new"),
)
def test_joint_that_comes_back(missing_joint: Run) -> None:
    """A joint that was missing counts as new when it comes back."""
    must_name_the_right_joints(missing_joint)


@check(
    points=3,
    hint="Publish nothing when dt is 0, but remember the message for the next one.",
    depends=PUBLISHES,
    misconception="divides by dt = 0",
    rule=("same_stamp", "clock"),
)
def test_repeated_stamp(repeated_stamp: Run) -> None:
    """Nothing is published when the stamp is the same as before; then it continues as usual."""
    must_be_silent_and_go_on(repeated_stamp)


@check(
    points=2,
    hint="Publish nothing when dt is negative, but remember the message for the next one.",
    depends=PUBLISHES,
    misconception="negative dt",
    rule=("same_stamp", "clock", "both_parts"),
)
def test_backward_stamp(backward_stamp: Run) -> None:
    """Nothing is published when the stamp goes back; then it continues as usual."""
    must_be_silent_and_go_on(backward_stamp)


@check(
    points=2,
    hint="Remember the message at the end of the callback, whether you published or not.",
    depends=VELOCITY,
    rule=("remember", "dt", "velocity", "before", "both_parts", "velocities"),
)
def test_remembers_what_it_does_not_answer(repeated_stamp: Run, backward_stamp: Run) -> None:
    """A message to which it publishes nothing counts for the next one."""
    for run in (repeated_stamp, backward_stamp):
        run.must_match("velocity", per="name", missing_ok=True)
        for before, now in itertools.pairwise(list(run)[1:]):
            if not before.answers and not before.expected and now.expected and not now.answers:
                run.wrong(now, "an answer was expected, got none.", "", "a message", "nothing")


@check(
    points=4,
    hint="Divide by the whole time, however long.",
    todo="After 30 s without a message, the next one is handled as usual: the difference of the positions, "
    "divided by 30 s. Look for a line that limits the time, such as min(dt, 1.0), for one that takes a "
    "long time to be an error, and for one that forgets the joints after a while.",
    depends=VELOCITY,
    rule=("gap", "dt", "velocity", "before", "both_parts", "velocities"),
)
def test_long_gap(gap: Run) -> None:
    """Velocities are right after 30 s without a message."""
    must_answer_late_ones(gap, 5.0)
    gap.must_match("velocity", per="name", missing_ok=True)


@check(
    points=3,
    hint="Use math.isfinite(position). Leave such a joint out, now and the next time.",
    depends=PUBLISHES,
    rule=("finite", "missing", "in_both", "new"),
)
def test_not_finite(not_finite: Run) -> None:
    """A joint whose position is not a number or infinite is left out; the others are not."""
    must_name_the_right_joints(not_finite)


@check(
    points=1,
    hint="Remember an empty message, too: after it, every joint is new.",
    depends=PUBLISHES,
    rule=("empty", "nothing_left", "missing", "remember", "new"),
)
def test_empty_message(empty: Run) -> None:
    """Nothing is published for an empty message, nor for the one after it."""
    empty.must_be_silent()
    messages, answers = len(empty.messages_on(reference=True)), len(empty.messages_on())
    if answers > messages:
        empty.wrong_at(None, f"expected {messages} messages, got {answers}.", "", messages, answers)
    must_name_the_right_joints(empty)


@check(
    points=1,
    hint="zip() ends with the shorter list.",
    depends=PUBLISHES,
    rule=("short", "missing", "new"),
)
def test_fewer_positions_than_names(short: Run) -> None:
    """Joints without a position are left out; the others are not."""
    must_name_the_right_joints(short)


@check(
    points=3,
    hint="Keep the callback short; never sleep in it.",
    depends=PUBLISHES,
    rule=("burst", "one_answer"),
)
def test_burst(burst: Run) -> None:
    """Each of 200 messages in 0.2 s gets its answer."""
    burst.must_answer()


@check(
    points=2,
    hint="Nothing is special about it: the position jumps. Publish the result, however large.",
    depends=VELOCITY,
    rule=("restart", "velocity"),
)
def test_publisher_restarts(restarted: Run) -> None:
    """When another publisher starts from zero, the velocity of the jump is published, however large."""
    restarted.must_match("velocity", per="name", missing_ok=True)


@check(
    points=1,
    hint="Create the publisher once, in __init__.",
    depends=PUBLISHES,
    rule="one_publisher",
)
def test_one_publisher(chapter: Run) -> None:
    """There is exactly one publisher on /joint_velocities."""
    count = len(chapter.publishers(VELOCITIES))
    if count != 1:
        fail(f"Publishers on {VELOCITIES}.", expected=1, got=count)


@check(
    points=2,
    hint="Publish only on /joint_velocities.",
    depends=PUBLISHES,
    rule="other_topics",
)
def test_leaves_other_topics_alone(chapter: Run) -> None:
    """It publishes nothing on /joint_commands and nothing on /clock."""
    for topic in (COMMANDS, CLOCK):
        if chapter.publishers(topic):
            fail(f"Your node has a publisher on {topic}.", expected="none", got=len(chapter.publishers(topic)))


@check(
    points=1,
    hint="Give create_publisher and create_subscription a plain 10.",
    depends=PUBLISHES,
    rule="queue",
)
def test_quality_of_service(chapter: Run) -> None:
    """Both ends are reliable and volatile, as a queue depth alone makes them, and their depth is 10."""
    chapter.must_have_qos(depth=True)
