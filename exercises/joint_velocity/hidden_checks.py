"""The harder scenarios of `joint_velocity`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

COMMANDS, VELOCITIES, CLOCK = "/joint_commands", "/joint_velocities", "/clock"

PUBLISHES = ["test_publishes_velocities"]
FOLLOWS = ["test_velocities_follow_the_joints"]
VELOCITY = ["test_velocity_of_each_joint"]


@check(
    points=4,
    hint="dt is not always 0.1 s. Take it from the stamps.",
    depends=VELOCITY,
    misconception="fixed dt",
    rule="dt is the time between the two stamps, in seconds.",
)
def test_speed_that_never_changes(steady: Run) -> None:
    """A joint that moves at a constant speed has that velocity, whenever the messages arrive."""
    speeds = {"left_elbow": 0.25, "right_elbow": -1.5, "left_shoulder_pitch": 0.0}
    for exchange in list(steady)[1:]:
        for answer in exchange.answers:
            for joint, velocity in answer.by("name", "velocity").items():
                if abs(velocity - speeds.get(joint, 0.0)) > 1e-6:
                    text = f"expected velocity {speeds.get(joint, 0.0):g} rad/s, got {velocity:.6g} rad/s."
                    steady.wrong(exchange, text, joint, f"{speeds.get(joint, 0.0):g}", f"{velocity:.6g}")
    steady.must_match("velocity", per="name")


@check(
    points=5,
    hint="A message may arrive late. Its stamp says when it was true, the clock only when it arrived.",
    depends=VELOCITY,
    misconception="time of arrival for the stamp",
    rule="dt is the time between the two stamps, in seconds.",
)
def test_late_messages(delayed: Run) -> None:
    """Velocities are right when messages arrive later than their stamps say."""
    delayed.must_match("velocity", per="name")


@check(
    points=2,
    hint="Copy the header as a whole. The node's clock says when the message arrived, not when it was true.",
    depends=["test_stamp_is_copied"],
    misconception="time of arrival for the stamp",
    rule="Copy both stamp and frame_id.",
)
def test_stamp_of_late_messages(delayed: Run) -> None:
    """The stamp is that of the message that arrived, even if it arrived late."""
    delayed.must_match("header.stamp", missing_ok=True)


@check(
    points=2,
    hint="Copy the header as a whole: it holds the stamp and the frame.",
    depends=FOLLOWS,
    rule="Copy both stamp and frame_id.",
)
def test_frame_is_copied(delayed: Run) -> None:
    """The frame is that of the message that arrived, even if it changes."""
    delayed.must_match("header.frame_id", missing_ok=True)


@check(
    points=4,
    hint="Neither time.time() nor the node's clock: only the stamps tell the time.",
    depends=FOLLOWS,
    misconception="wall clock",
    rule="Never read the computer's clock (time.time()).",
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
    depends=VELOCITY,
    rule="The message just before is the last one that arrived.",
)
def test_lost_messages(lossy: Run) -> None:
    """Velocities are right when messages are lost."""
    lossy.must_match("velocity", per="name")


@check(
    points=6,
    hint="Remember positions by name, not by index in the list.",
    depends=VELOCITY,
    misconception="joints by index",
    rule="The order of the joints may change from message to message.",
)
def test_joints_in_another_order(reordered: Run) -> None:
    """Velocities are right when the joints are in another order in each message."""
    reordered.must_match("velocity", per="name")


@check(
    points=2,
    hint="Take the names from the message that arrived, not from the one before or from a list of your own.",
    depends=["test_names_in_the_order_of_the_message", *VELOCITY],
    misconception="names in the order of another message",
    rule="name holds the joints' names, in the order of the message that arrived.",
)
def test_names_in_another_order(reordered: Run) -> None:
    """The joints' names are in the order of the message that arrived, even if the order changes."""
    reordered.must_match("name", missing_ok=True)


@check(
    points=2,
    hint="Leave out a joint that the message just before did not have.",
    depends=VELOCITY,
    rule="It was not in the message just before. Leave it out this time.",
)
def test_new_joint(new_joint: Run) -> None:
    """A joint that is new is left out once."""
    new_joint.must_match("velocity", per="name")


@check(
    points=2,
    hint="Compare with the message just before, and with no older one.",
    depends=VELOCITY,
    misconception="remembers joints that were missing",
    rule="When it comes back, it counts as new.",
)
def test_joint_that_comes_back(missing_joint: Run) -> None:
    """A joint that was missing counts as new when it comes back."""
    missing_joint.must_match("velocity", per="name")


@check(
    points=4,
    hint="Publish nothing when dt is 0.",
    depends=VELOCITY,
    misconception="divides by dt = 0",
    rule="The stamp is the same as before, or earlier. Then dt is zero or negative. Publish nothing.",
)
def test_repeated_stamp(repeated_stamp: Run) -> None:
    """Nothing is published when the stamp is the same as before; then it continues as usual."""
    _silent_and_right(repeated_stamp)


@check(
    points=3,
    hint="Publish nothing when dt is negative.",
    depends=VELOCITY,
    misconception="negative dt",
    rule="The stamp is the same as before, or earlier. Then dt is zero or negative. Publish nothing.",
)
def test_backward_stamp(backward_stamp: Run) -> None:
    """Nothing is published when the stamp goes back; then it continues as usual."""
    _silent_and_right(backward_stamp)


@check(
    points=4,
    hint="Divide by the whole time, however long.",
    depends=VELOCITY,
    rule="Divide by the whole time between the stamps, even if it is 30 s.",
)
def test_long_gap(gap: Run) -> None:
    """Velocities are right after 30 s without a message."""
    gap.must_match("velocity", per="name")


@check(
    points=3,
    hint="Use math.isfinite(position). Leave such a joint out, now and the next time.",
    depends=VELOCITY,
    rule="This counts as if the joint were missing from that message. All other joints are handled as usual.",
)
def test_not_finite(not_finite: Run) -> None:
    """A joint whose position is not a number or infinite is left out; the others are not."""
    not_finite.must_match("velocity", per="name")


@check(
    points=1,
    hint="After an empty message every joint is new.",
    depends=VELOCITY,
    rule="Then every joint is missing from it.",
)
def test_empty_message(empty: Run) -> None:
    """Nothing is published for an empty message, nor for the one after it."""
    _silent_and_right(empty)


@check(
    points=1,
    hint="zip() ends with the shorter list.",
    depends=VELOCITY,
    rule="Names without a position count as missing from that message.",
)
def test_fewer_positions_than_names(short: Run) -> None:
    """Joints without a position are left out; the others are not."""
    short.must_match("velocity", per="name")


@check(
    points=3,
    hint="Keep the callback short; never sleep in it.",
    depends=VELOCITY,
    rule="Answer each of them.",
)
def test_burst(burst: Run) -> None:
    """Each of 200 messages in 0.2 s gets its answer."""
    burst.must_match("velocity", per="name")


@check(
    points=2,
    hint="Nothing is special about it: the position jumps. Publish the result, however large.",
    depends=VELOCITY,
    rule="Publish the velocity of the jump, however large.",
)
def test_publisher_restarts(restarted: Run) -> None:
    """When another publisher starts from zero, the velocity of the jump is published, however large."""
    restarted.must_match("velocity", per="name")


@check(
    points=1,
    hint="Create the publisher once, in __init__.",
    depends=PUBLISHES,
    rule="Create exactly one publisher on /joint_velocities.",
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
    rule="Publish nothing on /joint_commands and nothing on /clock.",
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
    rule="A number alone makes both ends reliable and volatile, as the chapter's are.",
)
def test_quality_of_service(chapter: Run) -> None:
    """Both ends are reliable and volatile, as a queue depth alone makes them."""
    chapter.must_have_qos()


def _silent_and_right(run: Run) -> None:
    run.must_be_silent()
    run.must_match("velocity", per="name")
