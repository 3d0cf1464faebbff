"""What every student may read: the checks of `robot_description`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check, fail


@check(points=8, hint="Create the publisher in __init__, and publish what the parameter says.")
def test_publishes_the_description(late: Run) -> None:
    """It publishes the description on /robot_description at the start."""
    late.must_have_interface()
    late.must_publish()


@check(
    points=8,
    hint="QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)",
    depends=[test_publishes_the_description],
    misconception="volatile",
)
def test_late_subscriber(late: Run) -> None:
    """Late subscribers get the description, too."""
    late.must_match_series(subscriber="late at 1 s")
    late.must_match_series(subscriber="late at 2 s")


@check(
    points=4,
    hint="Reliable is the default. Transient local is not.",
    depends=[test_publishes_the_description],
)
def test_quality_of_service(late: Run) -> None:
    """The publisher is reliable and transient local."""
    late.must_have_qos()


@check(
    points=4,
    hint="A latched topic needs no timer.",
    depends=[test_publishes_the_description],
    misconception="again and again",
)
def test_publishes_once(late: Run) -> None:
    """It publishes the description once."""
    late.must_publish(count=1)


@check(
    points=6,
    hint="declare_parameter() returns the parameter with the value that the node was started with.",
    depends=[test_publishes_the_description],
)
def test_description_of_the_start(started: Run) -> None:
    """The node can be started with another description."""
    started.must_match_series()


@check(points=2, hint="super().__init__('robot_description')", depends=[test_publishes_the_description])
def test_node_is_called_robot_description(late: Run) -> None:
    """There is one node, it is called robot_description, and it publishes on no other topics."""
    late.must_have_nodes()
    declared = {topic.name for topic in late.exercise.outputs}
    if others := sorted({end.topic for end in late.end_points("publisher")} - declared):
        fail("Your node publishes on other topics, too.", expected="none", got=", ".join(others))


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_publishes_the_description],
)
def test_ends_on_ctrl_c(late: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    late.must_end_on_ctrl_c()
