"""What every student may read: the checks of `motor_switch`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the emergencies.
"""

from __future__ import annotations

from grader.checking import Run, check, fail

MOTORS = "/motors_on"


@check(points=8, hint="Create the service in __init__. Its callback returns the response.")
def test_responds(switching: Run) -> None:
    """It has the service /switch_motors and both topics, and responds to each request."""
    switching.must_have_interface()
    switching.must_respond()


@check(points=10, hint="response.success says whether the request was carried out.", depends=[test_responds])
def test_success(switching: Run) -> None:
    """success is true when the motors are as requested."""
    switching.must_match_responses("success")


@check(
    points=8,
    hint="Switch first, then report the state of the motors.",
    depends=[test_responds],
    misconception="the state before the request",
)
def test_message(switching: Run) -> None:
    """message gives the state of the motors after the request."""
    switching.must_match_responses("message")


@check(
    points=10,
    hint="Publish at the moment when the motors are switched.",
    depends=[test_responds],
)
def test_publishes_each_change(switching: Run) -> None:
    """It publishes true when the motors go on, and false when they go off."""
    switching.must_match_series("data", MOTORS, time=0.06)


@check(
    points=7,
    hint="Compare the request with the state before you publish. success is true in either case.",
    depends=[test_success, test_publishes_each_change],
)
def test_nothing_to_do(already: Run) -> None:
    """When the motors are already as requested, it says so, and publishes nothing."""
    already.must_match_responses("success")
    already.must_match_series("data", MOTORS, time=0.06)


@check(points=3, hint="super().__init__('motor_switch')", depends=[test_responds])
def test_node_is_called_motor_switch(switching: Run) -> None:
    """There is one node, it is called motor_switch, and it publishes on no other topics."""
    switching.must_have_nodes()
    declared = {topic.name for topic in switching.exercise.outputs}
    if others := sorted({end.topic for end in switching.end_points("publisher")} - declared):
        fail("Your node publishes on other topics, too.", expected="none", got=", ".join(others))


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_responds],
)
def test_ends_on_ctrl_c(switching: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    switching.must_end_on_ctrl_c()
