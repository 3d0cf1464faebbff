"""`ros2 topic pub`."""

from __future__ import annotations

import re

import pytest
from ros2_terminal import Robot, Terminal

pytestmark = pytest.mark.usefixtures("ros_domain")


def test_once_reaches_a_subscription_and_prints_what_the_real_command_prints(robot: Robot, terminal: Terminal) -> None:
    listener = robot("counter")
    answer = terminal.ros2("topic", "pub", "--once", "--stdin", "/cmd", "std_msgs/msg/String", stdin="data: sit\n")
    assert answer.out == "publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='sit')\n\n"
    assert answer.code == 0
    assert listener.stdout is not None
    assert listener.stdout.readline() == "sit\n"


def test_every_one_of_several_messages_arrives(robot: Robot, terminal: Terminal) -> None:
    listener = robot("counter")
    answer = terminal.ros2("topic", "pub", "-t", "5", "-r", "50", "-p", "5", "/cmd", "std_msgs/msg/String", "data: x")
    assert answer.out == "publisher: beginning loop\npublishing #5: std_msgs.msg.String(data='x')\n\n"
    assert listener.stdout is not None
    assert [listener.stdout.readline() for _ in range(5)] == ["x\n"] * 5


def test_once_waits_for_a_subscription(robot: Robot, terminal: Terminal) -> None:
    pub = terminal.start("topic", "pub", "-1", "/cmd", "std_msgs/msg/String", "data: late")
    assert pub.lines(1) == ["Waiting for at least 1 matching subscription(s)..."]
    listener = robot("counter")
    assert listener.stdout is not None
    assert listener.stdout.readline() == "late\n"
    assert pub.process.wait(60) == 0


def test_the_wait_can_be_limited(terminal: Terminal) -> None:
    answer = terminal.ros2("topic", "pub", "-1", "--max-wait-time-secs", "0.2", "/cmd", "std_msgs/msg/String")
    assert answer.code == 1
    assert answer.err.startswith(
        "Timed out waiting for subscribers: Expected 1 subscribers but only got 0 subscribers\n"
    )


def test_auto_and_now_are_the_time_of_publishing(terminal: Terminal) -> None:
    auto = terminal.ros2("topic", "pub", "-1", "-w", "0", "/pose", "geometry_msgs/msg/PoseStamped", "{header: auto}")
    now = terminal.ros2("topic", "pub", "-1", "-w", "0", "/tick", "builtin_interfaces/msg/Time", "{sec: 3}")
    stamped = terminal.ros2("topic", "pub", "-1", "-w", "0", "/head", "std_msgs/msg/Header", "{stamp: now}")
    for out in (auto.out, stamped.out):
        assert re.search(r"Time\(sec=[1-9]\d{8,}, nanosec=\d+\)", out)
    assert "Time(sec=3, nanosec=0)" in now.out


@pytest.mark.parametrize(
    ("kind", "values", "first", "then"),
    [
        ("geometry_msgs/msg/Twist", "{linear: {w: 1.0}}", "no attribute 'w' in 'linear'", "x (double), y (double)"),
        ("geometry_msgs/msg/Twist", "{linear: {x: fast}}", "'linear.x' got 'fast'", "a number (double)"),
        ("geometry_msgs/msg/Twist", "{linear: 3.0}", "'linear' got 3.0", "fields of geometry_msgs/msg/Vector3"),
        ("std_msgs/msg/Int8", "{data: 300}", "'data' got 300", "from -128 to 127 (int8)"),
        ("std_msgs/msg/Int8", "{data: 2.5}", "'data' got 2.5", "a whole number"),
        ("std_msgs/msg/Bool", "{data: maybe}", "'data' got 'maybe'", "true or false"),
        ("sensor_msgs/msg/JointState", "{position: 1.0}", "'position' got 1.0", "a list"),
        ("sensor_msgs/msg/JointState", "{position: [1, a]}", "'position[1]' got 'a'", "a number"),
        ("test_msgs/msg/Arrays", "{int32_values: [1]}", "'int32_values' got [1]", "exactly 3 values"),
        ("test_msgs/msg/BoundedSequences", "{bool_values: [1, 1, 1, 1]}", "'bool_values' got", "at most 3 values"),
        ("std_msgs/msg/Int8", "{off: 3}", "no attribute 'False'", "quote it"),
        ("std_msgs/msg/Int8", "data:3", "needs to be a dictionary", "blank after the colon"),
        ("std_msgs/msg/Int8", "{data: 3", "is not YAML", "Quote it"),
        ("std_msgs/msg/Int9", "{}", "no type 'msg/Int9'", "std_msgs/msg/Int8"),
        ("Int8", "{}", "message type is invalid: 'Int8'", "PACKAGE/msg/NAME"),
        ("turtlesim/msg/Pos", "{}", "no type 'msg/Pos'", "turtlesim/msg/Pose"),
        ("nopkg/msg/Int64", "{}", "Unknown package 'nopkg'", "std_msgs/msg/Int64"),
    ],
)
def test_what_was_typed_wrong_is_said_at_once(
    terminal: Terminal, kind: str, values: str, first: str, then: str
) -> None:
    answer = terminal.ros2("topic", "pub", "--once", "/cmd", kind, values)
    head, _, rest = answer.err.partition("\n")
    assert answer.code == 1
    assert answer.out == ""
    assert first in head
    assert then in rest


def test_a_name_that_is_none(terminal: Terminal) -> None:
    answer = terminal.ros2("topic", "pub", "--once", "a b", "std_msgs/msg/Int8")
    assert answer.code == 1
    assert answer.err.startswith("'a b' is not a valid name for a topic")
