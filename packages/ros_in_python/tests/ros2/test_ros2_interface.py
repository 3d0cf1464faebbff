"""`ros2 interface`, which needs no node."""

from __future__ import annotations

from pathlib import Path

import pytest
from ros2_terminal import Terminal

from interface_compiler import prefixes


def test_show_unfolds_nested_types_without_their_comments(terminal: Terminal) -> None:
    lines = terminal.ros2("interface", "show", "sensor_msgs/msg/JointState").out.splitlines()
    assert lines[0] == "# This is a message that holds data to describe the state of a set of torque controlled joints."
    assert lines[1] == "#"
    assert lines[-10:] == [
        "std_msgs/Header header",
        "\tbuiltin_interfaces/Time stamp",
        "\t\tint32 sec",
        "\t\tuint32 nanosec",
        "\tstring frame_id",
        "",
        "string[] name",
        "float64[] position",
        "float64[] velocity",
        "float64[] effort",
    ]


def test_show_with_no_and_with_all_comments(terminal: Terminal) -> None:
    bare = terminal.ros2("interface", "show", "--no-comments", "std_srvs/srv/SetBool").out
    assert bare == "bool data\n---\nbool success\nstring message\n"
    full = terminal.ros2("interface", "show", "--all-comments", "sensor_msgs/msg/JointState").out
    assert "\t\t# The seconds component, valid over all int32 values.\n" in full


def test_show_reads_the_type_from_a_pipe(terminal: Terminal) -> None:
    out = terminal.ros2("interface", "show", "-", stdin="test_msgs/action/Fibonacci\n").out
    assert out.splitlines() == [
        "#goal definition",
        "int32 order",
        "---",
        "#result definition",
        "int32[] sequence",
        "---",
        "#feedback",
        "int32[] sequence",
    ]


def test_show_leaves_a_number_sign_in_a_default_alone(terminal: Terminal) -> None:
    out = terminal.ros2("interface", "show", "--no-comments", "test_msgs/msg/Strings").out
    assert 'string string_value_default2 "Hello\'world!"\n' in out


def test_proto_is_yaml_in_quotes(terminal: Terminal) -> None:
    yaml = "linear:\n  x: 0.0\n  y: 0.0\n  z: 0.0\nangular:\n  x: 0.0\n  y: 0.0\n  z: 0.0\n"
    assert terminal.ros2("interface", "proto", "geometry_msgs/msg/Twist").out == f'"{yaml}"\n'
    assert terminal.ros2("interface", "proto", "--no-quotes", "test_msgs/action/Fibonacci").out == "order: 0\n\n"


def test_lists(terminal: Terminal, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # outside a course, whose own types would be listed, too
    assert terminal.ros2("interface", "list", "-a").out == (
        "Actions:\n    example_interfaces/action/Fibonacci\n"
        "    test_msgs/action/Fibonacci\n    test_msgs/action/NestedMessage\n"
        "    tf2_msgs/action/LookupTransform\n    turtlesim/action/RotateAbsolute\n"
    )
    everything = terminal.ros2("interface", "list").out.splitlines()
    assert everything[:2] == ["Messages:", "    action_msgs/msg/GoalInfo"]
    assert "Services:" in everything
    assert set(terminal.ros2("interface", "package", "std_srvs").out.split()) == {
        "std_srvs/srv/Trigger",
        "std_srvs/srv/Empty",
        "std_srvs/srv/SetBool",
    }
    packages = terminal.ros2("interface", "packages").out.split()
    assert packages == sorted(packages)
    assert {"geometry_msgs", "sensor_msgs", "test_msgs"} <= set(packages)


def test_what_is_not_installed(terminal: Terminal) -> None:
    pose = terminal.ros2("interface", "show", "turtlesim/msg/Pos")
    assert pose.code == 1
    assert "Did you mean" in pose.err
    assert "turtlesim/msg/Pose" in pose.err
    close = terminal.ros2("interface", "show", "sensor_msgs/msg/JointStates")
    assert "Did you mean sensor_msgs/msg/JointState" in close.err
    short = terminal.ros2("interface", "show", "sensor_msgs/JointState")
    assert short.err.startswith("Invalid name 'sensor_msgs/JointState'. Expected three parts separated by '/'\n")
    assert terminal.ros2("interface", "package", "nopkg").err.startswith("Unknown package 'nopkg'\n")
    if prefixes.prefix_of("nav2_msgs", prefixes.installed()) is None:
        assert terminal.ros2("interface", "package", "nav2_msgs").err.splitlines() == [
            "Unknown package 'nav2_msgs'",
            "Compile it, once: python -m interface_compiler add nav2_msgs",
        ]
