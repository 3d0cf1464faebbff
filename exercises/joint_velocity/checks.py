"""What every student may read: the checks of `joint_velocity`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check, fail

COMMANDS, VELOCITIES = "/joint_commands", "/joint_velocities"
JOINT_STATE = "sensor_msgs/msg/JointState"


@check(points=3, hint="Create the subscription and the publisher in __init__, and call publish() in the callback.")
def test_publishes_velocities(chapter: Run) -> None:
    """It hears /joint_commands and publishes JointState messages on /joint_velocities."""
    if not chapter.subscriptions(COMMANDS):
        fail(
            "Your node does not subscribe the topic.",
            expected=COMMANDS,
            got=", ".join(chapter.topics("subscription")) or "none",
        )
    for subscription in chapter.subscriptions(COMMANDS):
        if subscription.type != JOINT_STATE:
            fail("Your subscription has another type.", expected=JOINT_STATE, got=subscription.type)
    if not chapter.publishers(VELOCITIES):
        fail(
            "Your node has no publisher on the topic.",
            expected=VELOCITIES,
            got=", ".join(chapter.topics("publisher")) or "none",
        )
    for publisher in chapter.publishers(VELOCITIES):
        if publisher.type != JOINT_STATE:
            fail("Your publisher has another type.", expected=JOINT_STATE, got=publisher.type)
    if not chapter.received:
        fail(f"Nothing was published on {VELOCITIES}.", expected="99 messages", got="none")


@check(points=4, hint="One callback, one publish().", depends=[test_publishes_velocities])
def test_answers_each_message_once(chapter: Run) -> None:
    """It publishes one message for each message after the first."""
    chapter.must_answer()


@check(
    points=4,
    hint="Before the first message there is nothing to compare with. Remember it and return.",
    depends=[test_publishes_velocities],
    misconception="publishes on the first message",
)
def test_says_nothing_to_the_first_message(chapter: Run) -> None:
    """It publishes nothing for the first message."""
    chapter.must_be_silent_at_first()


@check(
    points=10,
    hint="(position now - position before) / (stamp now - stamp before), for each joint, in rad/s.",
    depends=[test_publishes_velocities],
)
def test_velocity_of_each_joint(chapter: Run) -> None:
    """Each joint's velocity is its change of position over the time between the two stamps."""
    chapter.must_match("velocity", per="name")


@check(
    points=4,
    hint="Copy the names from the message that arrived, in their order.",
    depends=[test_publishes_velocities],
)
def test_names_in_the_order_of_the_message(chapter: Run) -> None:
    """The joints' names stand in the order of the message that arrived."""
    chapter.must_match("name", missing_ok=True)


@check(
    points=5,
    hint="Copy the header of the message that arrived, as a whole: it holds the stamp.",
    depends=[test_publishes_velocities],
    misconception="forgets the stamp",
)
def test_stamp_is_copied(chapter: Run) -> None:
    """The stamp is that of the message that arrived."""
    chapter.must_match("header.stamp", missing_ok=True)


@check(points=3, hint="super().__init__('joint_velocity')", depends=[test_publishes_velocities])
def test_node_is_called_joint_velocity(chapter: Run) -> None:
    """There is one node, and it is called joint_velocity."""
    if chapter.nodes != ("/joint_velocity",):
        fail("The node has another name.", expected="/joint_velocity", got=", ".join(chapter.nodes))


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_publishes_velocities],
)
def test_ends_on_ctrl_c(chapter: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    if not chapter.ending.ended_in_time:
        fail("After Ctrl-C the node went on.", expected="an end within 2 s", got="none")
    if chapter.ending.traceback:
        fail("After Ctrl-C the node printed a traceback.", expected="none", got=chapter.ending.traceback)
