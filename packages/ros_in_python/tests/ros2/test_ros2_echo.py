"""`ros2 topic echo`."""

from __future__ import annotations

import re

import pytest
from ros2_terminal import Robot, Terminal

pytestmark = pytest.mark.usefixtures("ros_domain")


def test_a_message_is_yaml_as_the_real_command_prints_it(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    answer = terminal.ros2("topic", "echo", "--once", "/joint_commands")
    assert re.sub(r"sec: \d+", "sec: 1", answer.out) == (
        "header:\n"
        "  stamp:\n"
        "    sec: 1\n"
        "    nanosec: 1\n"
        "  frame_id: ''\n"
        "name:\n"
        "- a\n"
        "- b\n"
        "position:\n"
        "- 0.25\n"
        "- 0.5\n"
        "velocity:\n"
        "- 0.0\n"
        "- 0.0\n"
        "effort: []\n"
        "---\n"
    )
    assert answer.code == 0


def test_once_prints_one_message_though_more_have_come(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    assert terminal.ros2("topic", "echo", "--once", "/joint_commands").out.count("---\n") == 1


def test_a_field_is_printed_as_python_has_it(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    out = terminal.ros2("topic", "echo", "--once", "/joint_commands", "--field", "position").out
    assert out == "array('d', [0.25, 0.5])\n---\n"


def test_a_nested_field(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    out = terminal.ros2("topic", "echo", "--once", "/joint_commands", "--field", "header.stamp").out
    assert re.fullmatch(r"sec: \d+\nnanosec: \d+\n---\n", out)


def test_an_element_of_a_list(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    assert terminal.ros2("topic", "echo", "--once", "/joint_commands", "--field", "position[1]").out == "0.5\n---\n"
    missing = terminal.ros2("topic", "echo", "--once", "/joint_commands", "--field", "position[2]")
    assert (missing.code, "the list has no such element" in missing.err) == (1, True)


def test_csv(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    out = terminal.ros2("topic", "echo", "--once", "--csv", "/joint_commands").out
    assert re.fullmatch(r"\d+,\d+,,a,b,0\.25,0\.5,0\.0,0\.0,\n", out)


def test_arrays_left_out_or_on_one_line(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    short = terminal.ros2("topic", "echo", "--once", "--no-arr", "/joint_commands").out
    assert "\nposition: '<sequence type: double, length: 2>'\n" in short
    assert (
        "\nposition: [0.25, 0.5]\n" in terminal.ros2("topic", "echo", "--once", "--flow-style", "/joint_commands").out
    )


def test_a_late_echo_hears_what_a_transient_local_publisher_said_before(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    assert terminal.ros2("topic", "echo", "--once", "/robot_name").out == "data: Ada\n---\n"


def test_a_best_effort_publisher_is_heard(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    assert terminal.ros2("topic", "echo", "--once", "count").out.startswith("data: ")


def test_qos_asked_for_is_not_changed(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    answer = terminal.ros2("topic", "echo", "--once", "--timeout", "1", "--qos-reliability", "reliable", "/count")
    assert answer.out == ""
    assert "incompatible QoS" in answer.err
    assert answer.err.endswith("No message on /count within 1 s.\n")


def test_a_filter_chooses(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    answer = terminal.ros2("topic", "echo", "--once", "/count", "--filter", "m.data % 7 == 0")
    assert int(answer.out.splitlines()[0].removeprefix("data: ")) % 7 == 0


def test_an_unknown_field_is_refused_before_any_message(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    answer = terminal.ros2("topic", "echo", "/joint_commands", "--field", "pos")
    assert answer.code == 1
    assert answer.err.startswith("Invalid field 'pos': 'JointState' object has no attribute 'pos'\n")
    assert "position (sequence<double>)" in answer.err


def test_a_topic_that_is_not_there(terminal: Terminal) -> None:
    answer = terminal.ros2("topic", "echo", "/nowhere")
    assert answer.code == 1
    assert answer.out == "WARNING: topic [/nowhere] does not appear to be published yet\n"
    assert answer.err.startswith("Could not determine the type for the passed topic\n")


def test_with_its_type_named_a_topic_is_waited_for(robot: Robot, terminal: Terminal) -> None:
    echo = terminal.start("topic", "echo", "/count", "std_msgs/msg/Int32")
    robot("counter")
    assert echo.lines(2)[1] == "---"
    assert echo.stop().err == ""


def test_messages_come_through_a_pipe_one_by_one(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    echo = terminal.start("topic", "echo", "/count")
    first, second = echo.lines(4)[::2]
    assert int(second.removeprefix("data: ")) == int(first.removeprefix("data: ")) + 1
