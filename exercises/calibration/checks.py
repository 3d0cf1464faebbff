"""What every student may read: the checks of `calibration`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check, fail

OFFSETS, PENDING = "/joint_offsets", "/calibrations_pending"


@check(points=8, hint="Call call_async() in the callback of /calibrate, with the joint's name in the request.")
def test_asks(one: Run) -> None:
    """It calls /calibrate_joint with the name of the joint that it received on /calibrate."""
    one.must_have_interface()
    one.must_match_requests("joint")


@check(
    points=10,
    hint="Use future.add_done_callback(…), and publish the offset in that callback.",
    depends=[test_asks],
)
def test_publishes_the_offset(one: Run) -> None:
    """When the answer comes, it publishes the offset on /joint_offsets."""
    one.must_match_series("position", OFFSETS, time=0.15)


@check(points=5, hint="name and position are lists, with one element each.", depends=[test_publishes_the_offset])
def test_publishes_the_name(one: Run) -> None:
    """The message on /joint_offsets has the joint's name."""
    one.must_match_series("name", OFFSETS)


@check(
    points=10,
    hint="Use a timer. It works as long as no callback waits.",
    depends=[test_asks],
    misconception="waits for the answer",
)
def test_ten_times_a_second(one: Run) -> None:
    """It publishes on /calibrations_pending ten times per second, even while it waits for an answer."""
    one.must_keep_rate(10.0, PENDING)
    one.must_have_no_gap(0.15, PENDING)


@check(points=8, hint="Count up for each request, and down for each answer.", depends=[test_ten_times_a_second])
def test_number_of_pending(one: Run) -> None:
    """/calibrations_pending says how many joints wait: 1 until the answer arrives, then 0."""
    one.must_match_series("data", PENDING)


@check(points=3, hint="super().__init__('calibration')", depends=[test_asks])
def test_node_is_called_calibration(one: Run) -> None:
    """There is one node, it is called calibration, and it publishes on no other topics."""
    one.must_have_nodes()
    declared = {topic.name for topic in one.exercise.outputs}
    if others := sorted({end.topic for end in one.end_points("publisher")} - declared):
        fail("Your node publishes on other topics, too.", expected="none", got=", ".join(others))


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_asks],
)
def test_ends_on_ctrl_c(one: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    one.must_end_on_ctrl_c()
