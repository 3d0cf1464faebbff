"""What every student may read: the checks of `robot_description`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check


def squeezed(text: str) -> str:
    """Return a text without spaces and line breaks: whether these are right is judged by a check of its own."""
    return "".join(text.split())


def published(run: Run) -> list[str]:
    """Return the texts that the node published, without spaces."""
    return [squeezed(message.fields["data"]) for message in run.messages_on()]


def must_start_with(run: Run) -> None:
    """Fail unless the node's first message is the solution's first, within 0.1 s after the start."""
    run.must_publish()
    first, expected = run.messages_on()[0], run.messages_on(reference=True)[0]
    got, right = first.fields["data"], expected.fields["data"]
    if squeezed(got) != squeezed(right):
        run.wrong_at(first.at, f"expected the text {right}, got {got}.", "", right, got)
    if (late := first.at - expected.at) > 0.110001:
        run.wrong_at(first.at, f"it was expected at the start, got it {late:.2f} s later.", "", "at the start", "later")


@check(
    points=5,
    hint="Create the publisher in __init__, and publish what the parameter says.",
    todo="In __init__: create the publisher, declare the parameter with the default of the task, and publish a "
    "String whose data is the parameter's value. get_parameter('robot_description').value is the value "
    "that counts, also if the node was started with another one. Declare before you get. No timer is "
    "needed: the publisher is latched, and keeps the message for those who come later.",
    rule=("topic", "parameter"),
)
def test_publishes_the_description(started: Run, changed: Run) -> None:
    """It publishes what its parameter says on /robot_description: at the start, or when the parameter changes."""
    started.must_have_interface()
    new = {squeezed(change.value) for change in changed.recording.parameters}
    of_start = squeezed(started.messages_on(reference=True)[0].fields["data"])
    if of_start not in published(started) and not new & set(published(changed)):
        started.must_publish()
        got = started.messages_on()[0].fields["data"]
        text = "the text is not the one that the parameter holds, neither at the start nor after a change: "
        text += f"expected {started.messages_on(reference=True)[0].fields['data']}, got {got}."
        changed.wrong_at(None, text, "", "the parameter's text", got)


@check(
    points=5,
    hint="What is published first, and when? Only the parameter's value, at the end of __init__.",
    todo="Publish once at the end of __init__, when the publisher and the parameter are there. Nobody has "
    "subscribed then, and nobody has to: a latched publisher keeps its last message. Do not wait for "
    "subscribers, and do not begin with an empty or an invented text.",
    depends=[test_publishes_the_description],
    rule="start",
)
def test_publishes_at_the_start(late: Run) -> None:
    """At the start it publishes the description."""
    must_start_with(late)


@check(
    points=8,
    hint="QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)",
    todo="A plain number as the last argument of create_publisher() is only a queue depth, and then the publisher "
    "is volatile: a message that it has sent is gone, and who subscribes later gets nothing. A QoSProfile "
    "(from rclpy.qos) says more: with the durability transient local, the publisher keeps its last messages "
    "for subscribers that come later, if they are transient local, too, and depth says how many. To see it, "
    "start your node, wait, and then run `ros2 topic echo --once /robot_description`.",
    depends=[test_publishes_the_description],
    misconception="volatile",
    rule=("late", "qos"),
)
def test_late_subscriber(late: Run, changed: Run) -> None:
    """Late subscribers get what was published before, too."""
    for run, name, seconds in ((late, "late at 1 s", 1.0), (late, "late at 2 s", 2.0), (changed, "late at 1.6 s", 1.6)):
        before = [message for message in run.messages_on() if message.at < seconds]
        if before and not run.messages_on(subscriber=name):
            volatile = any(end.durability == "volatile" for end in run.publishers("/robot_description"))
            best_effort = "It asks for reliable, and your publisher is not."
            why = "A volatile publisher keeps nothing for it." if volatile else best_effort
            text = f"the subscriber “{name}” got nothing. {why}"
            run.wrong_at(None, text, "", "the newest description", "nothing")


@check(
    points=3,
    hint="Reliable is the default. Transient local is not. The depth is the number of messages that are kept.",
    depends=[test_publishes_the_description],
    rule="qos",
)
def test_quality_of_service(late: Run) -> None:
    """The publisher is reliable and transient local, with a depth of 1."""
    late.must_have_qos(depth=True)


@check(
    points=4,
    hint="A latched topic needs no timer.",
    todo="Find every line that publishes, and ask when it runs. A timer that publishes again and again fills "
    "the log of everybody who listens. So does a callback that runs for every parameter, or a post-set "
    "callback in addition to the on-set callback. Publish in __init__, and after a change, and nowhere "
    "else.",
    depends=[test_publishes_the_description],
    misconception="again and again",
    rule="nothing_else",
)
def test_publishes_once(late: Run) -> None:
    """It does not publish the description again and again."""
    if (count := len(late.messages_on())) > 1:
        late.wrong_at(None, f"expected one message, got {count}.", "", "1 message", count)


@check(
    points=4,
    hint="Is the published text the parameter's value, or the default?",
    todo="The default counts only if nobody gives another text. Declare the parameter with its default, and then "
    "ask for its value: self.get_parameter('robot_description').value. A Parameter itself is not the text, "
    "and neither is str() of it. Publish this value, as it is, once, when the publisher exists. To try it, "
    "start the node with another text: `python3 robot_description.py --ros-args -p robot_description:='<robot "
    'name="arm"/>\'`, and look with `ros2 topic echo --once /robot_description`.',
    depends=[test_publishes_the_description],
    rule=("start_text", "start"),
)
def test_description_of_the_start(started: Run) -> None:
    """The node can be started with another description."""
    must_start_with(started)


@check(
    points=2,
    hint="super().__init__('robot_description')",
    depends=[test_publishes_the_description],
    rule=("node", "other_topics"),
)
def test_node_is_called_robot_description(late: Run) -> None:
    """There is one node, it is called robot_description, and it publishes on no other topics."""
    late.must_have_nodes()
    late.must_publish_on_no_others()


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_publishes_the_description],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(late: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    late.must_end_on_ctrl_c()
