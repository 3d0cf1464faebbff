"""What every student may read: the checks of `joint_velocity`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from statistics import correlation

from grader.checking import Run, check


@check(
    points=5,
    hint="Is publish() called in the callback of the subscription, with a JointState? Which numbers does velocity come "
    "from, and do they change from message to message?",
    todo="The callback gets one message per call, so it must remember the one before: its stamp, and the "
    "position of each joint by name. For each joint that is in both, subtract the two positions and "
    "divide by the seconds between the two stamps. Put the names into name and the results into velocity "
    "of a new JointState, and publish it at the end of the callback. Then remember this message for the "
    "next call.",
    misconception="publishes zeros or a constant",
    rule=("input", "output"),
)
def test_publishes_velocities(chapter: Run) -> None:
    """It subscribes to /joint_commands, and publishes JointState messages whose velocities follow the joints."""
    chapter.must_have_interface()
    chapter.must_publish()
    pairs = []
    for exchange in chapter:
        for answer, expected in zip(exchange.answers[:1], exchange.expected, strict=False):
            right = expected.by("name", "velocity")
            names = answer.name if len(answer.name) == len(answer.velocity) else expected.name
            pairs += [(right[n], got) for n, got in zip(names, answer.velocity, strict=False) if n in right]
    pairs = [pair for pair in pairs if all(abs(number) < 1e9 for number in pair)]
    if len({got for _, got in pairs}) < 2:
        chapter.must_vary("velocity", per="name")
    speeds = [(abs(right), abs(got)) for right, got in pairs]  # a sign that is lost is another check's question
    if len({got for _, got in speeds}) < 2 or (
        abs(correlation(*zip(*pairs, strict=True))) < 0.4 and correlation(*zip(*speeds, strict=True)) < 0.9
    ):
        chapter.must_match("velocity", per="name")
        text = "the velocities have nothing to do with how fast the joints move."
        chapter.wrong_at(None, text, "", "velocities that follow the joints", "others")


@check(
    points=4,
    hint="Which messages does the callback not answer, or answer twice? Is publish() in a loop, or behind a condition?",
    depends=[test_publishes_velocities],
    rule="one_answer",
    partial=True,
)
def test_answers_each_message_once(chapter: Run) -> None:
    """It publishes one message for each message after the first."""
    chapter.must_answer()


@check(
    points=3,
    hint="Publish in the callback, not from a timer or from a thread that sleeps.",
    depends=[test_publishes_velocities],
    misconception="answers late",
    rule="at_once",
)
def test_answers_at_once(chapter: Run) -> None:
    """Each answer goes out within 10 ms, and before the next message."""
    chapter.must_answer_at_once()


@check(
    points=3,
    hint="Before the first message there is nothing to compare with. Remember it and return.",
    depends=[test_publishes_velocities],
    misconception="publishes on the first message",
    rule="first",
)
def test_says_nothing_to_the_first_message(chapter: Run) -> None:
    """It publishes nothing for the first message."""
    chapter.must_be_silent_at_first()


@check(
    points=8,
    hint="Compute one joint's velocity for the second message by hand. Which part of yours differs?",
    todo="Velocity is a change divided by the time that it took: (position now - position before) / (stamp now - "
    "stamp before). Take both positions of the same joint, by its name, not by its index. Both stamps are in "
    "seconds: sec and nanosec belong together, and a nanosecond is a billionth of a second. Remember "
    "positions and stamp of this message at the end of the callback, after you have used those of the one "
    "before. Log position, position before and dt of one joint, and compare with your result.",
    depends=[test_publishes_velocities],
    rule=("velocity", "before", "dt", "both_parts", "velocities", "in_both", "clock"),
    partial=True,
)
def test_velocity_of_each_joint(chapter: Run) -> None:
    """Each joint's velocity is its change of position over the time between the two stamps."""
    chapter.must_match("velocity", per="name", missing_ok=True)


@check(
    points=5,
    hint="dt is not always 0.1 s. Take it from the stamps.",
    todo="The time between two messages changes, so the number by which you divide must change with it. Make "
    "one number of each stamp, seconds plus nanoseconds times 1e-9, and subtract the one before from this "
    "one. Log both stamps and the difference for a few messages. A constant such as 0.1, the period of a "
    "timer, or the mean of several is right only for a while.",
    depends=[test_velocity_of_each_joint],
    misconception="fixed dt",
    rule=("dt", "velocity", "before", "clock", "both_parts", "velocities"),
)
def test_uneven_times(irregular: Run) -> None:
    """Velocities are right when the messages arrive at uneven times."""
    irregular.must_match("velocity", per="name", missing_ok=True)


@check(
    points=3,
    hint="Copy the names from the message that arrived, in their order.",
    depends=[test_publishes_velocities],
    rule="names",
    partial=True,
)
def test_names_in_the_order_of_the_message(chapter: Run) -> None:
    """The joints' names are in the order of the message that arrived."""
    chapter.must_match("name", missing_ok=True)


@check(
    points=4,
    hint="Copy the header of the message that arrived, as a whole: it holds the stamp.",
    depends=[test_publishes_velocities],
    misconception="forgets the stamp",
    rule="header",
    partial=True,
)
def test_stamp_is_copied(chapter: Run) -> None:
    """The stamp is that of the message that arrived."""
    chapter.must_match("header.stamp", missing_ok=True)


@check(points=3, hint="super().__init__('joint_velocity')", depends=[test_publishes_velocities], rule="node")
def test_node_is_called_joint_velocity(chapter: Run) -> None:
    """There is one node, and it is called joint_velocity."""
    chapter.must_have_nodes()


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_publishes_velocities],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(chapter: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    chapter.must_end_on_ctrl_c()
