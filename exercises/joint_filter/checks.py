"""What every student may read: the checks of `joint_filter`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check, fail


@check(points=8, hint="Create the subscription and the publisher in __init__, and call publish() in the callback.")
def test_answers_each_message(default: Run) -> None:
    """It subscribes to /joint_commands, and publishes one message on /joint_filtered for each."""
    default.must_have_interface()
    default.must_publish()
    default.must_answer()


@check(
    points=10,
    hint="smooth = smooth + gain * (position - smooth), for each joint.",
    depends=[test_answers_each_message],
)
def test_filters_with_the_default(default: Run) -> None:
    """By default, the gain is 0.5."""
    default.must_match("position", per="name")


@check(points=4, hint="Copy the names from the message that arrived.", depends=[test_answers_each_message])
def test_names(default: Run) -> None:
    """The joints' names are those of the message that arrived, in their order."""
    default.must_match("name", missing_ok=True)


@check(points=4, hint="Copy the header as a whole.", depends=[test_answers_each_message])
def test_header(default: Run) -> None:
    """The header is that of the message that arrived."""
    default.must_match("header", missing_ok=True)


@check(points=3, hint="super().__init__('joint_filter')", depends=[test_answers_each_message])
def test_node_is_called_joint_filter(default: Run) -> None:
    """There is one node, it is called joint_filter, and it publishes on no other topics."""
    default.must_have_nodes()
    declared = {topic.name for topic in default.exercise.outputs}
    if others := sorted({end.topic for end in default.end_points("publisher")} - declared):
        fail("Your node publishes on other topics, too.", expected="none", got=", ".join(others))


@check(
    points=10,
    hint="declare_parameter('gain', 0.5, …), and get_parameter('gain').value where you need it.",
    depends=[test_filters_with_the_default],
    misconception="fixed gain",
)
def test_gain_of_the_start(started: Run) -> None:
    """The node can be started with another gain."""
    started.must_match("position", per="name")


@check(
    points=10,
    hint="Read the parameter for each message, or keep it up to date in a post-set callback.",
    depends=[test_gain_of_the_start, test_node_is_called_joint_filter],
    misconception="reads the gain once",
)
def test_gain_that_changes(changed: Run) -> None:
    """A new gain counts from the next message on."""
    changed.must_take("gain")
    changed.must_match("position", per="name")


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_answers_each_message],
)
def test_ends_on_ctrl_c(default: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    default.must_end_on_ctrl_c()
