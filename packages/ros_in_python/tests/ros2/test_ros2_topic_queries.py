"""`ros2 topic list`, `info`, `type` and `find`: the text of the real command, for a known graph."""

from __future__ import annotations

import re

import pytest
from ros2_terminal import Robot, Terminal

pytestmark = pytest.mark.usefixtures("ros_domain")


def test_list_names_the_topics(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    assert terminal.ros2("topic", "list").out == "/joint_commands\n/parameter_events\n/rosout\n"


def test_list_shows_types(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    assert terminal.ros2("topic", "list", "-t").out == (
        "/joint_commands [sensor_msgs/msg/JointState]\n"
        "/parameter_events [rcl_interfaces/msg/ParameterEvent]\n"
        "/rosout [rcl_interfaces/msg/Log]\n"
    )


def test_list_counts_ends(standing: Robot, terminal: Terminal) -> None:
    standing("counter", "latched")
    assert terminal.ros2("topic", "list", "-v").out == (
        "Published topics:\n"
        " * /count [std_msgs/msg/Int32] 1 publisher\n"
        " * /parameter_events [rcl_interfaces/msg/ParameterEvent] 2 publishers\n"
        " * /robot_name [std_msgs/msg/String] 1 publisher\n"
        " * /rosout [rcl_interfaces/msg/Log] 2 publishers\n"
        "\n"
        "Subscribed topics:\n"
        " * /cmd [std_msgs/msg/String] 1 subscriber\n"
        "\n"
    )


def test_list_leaves_out_hidden_topics_unless_asked(standing: Robot, terminal: Terminal) -> None:
    standing("counter")
    assert terminal.ros2("topic", "list", "-c").out == "4\n"
    assert "/_hidden\n" in terminal.ros2("topic", "list", "--include-hidden-topics").out


def test_the_command_does_not_list_itself(terminal: Terminal) -> None:
    assert terminal.ros2("topic", "list").out == ""
    assert terminal.ros2("node", "list", "-a").out == ""
    assert terminal.ros2("service", "list", "-a").out == ""


def test_info_tells_of_every_end(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    out = terminal.ros2("topic", "info", "-v", "/joint_commands").out
    assert re.sub(r"GID: [0-9a-f.]+", "GID: …", out) == (
        "Type: sensor_msgs/msg/JointState\n"
        "\n"
        "Publisher count: 1\n"
        "\n"
        "Node name: joint_publisher\n"
        "Node namespace: /\n"
        "Topic type: sensor_msgs/msg/JointState\n"
        "Topic type hash: RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e\n"
        "Endpoint type: PUBLISHER\n"
        "GID: …\n"
        "QoS profile:\n"
        "  Reliability: RELIABLE\n"
        "  History (Depth): UNKNOWN\n"
        "  Durability: VOLATILE\n"
        "  Lifespan: Infinite\n"
        "  Deadline: Infinite\n"
        "  Liveliness: AUTOMATIC\n"
        "  Liveliness lease duration: Infinite\n"
        "\n"
        "Subscription count: 0\n"
        "\n"
    )


def test_info_in_short(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    assert terminal.ros2("topic", "info", "/joint_commands").out == (
        "Type: sensor_msgs/msg/JointState\nPublisher count: 1\nSubscription count: 0\n"
    )
    assert terminal.ros2("topic", "info", "/parameter_events").out.splitlines()[1] == "Publisher count: 1"


def test_type_and_find(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    assert terminal.ros2("topic", "type", "/joint_commands").out == "sensor_msgs/msg/JointState\n"
    assert terminal.ros2("topic", "find", "sensor_msgs/msg/JointState").out == "/joint_commands\n"


def test_an_unknown_topic_is_refused_with_those_that_are_there(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    for verb in ("info", "type"):
        answer = terminal.ros2("topic", verb, "/joint_comands")
        assert answer.code == 1
        assert answer.out == ""
        assert answer.err.startswith("Unknown topic '/joint_comands'\n")
        assert "/joint_commands" in answer.err


def test_four_nodes_in_four_processes_are_all_listed(robot: Robot, terminal: Terminal) -> None:
    for _ in range(4):
        robot("latched")
    answer = terminal.ros2("node", "list")
    assert answer.out == "/namer\n" * 4
    assert "share an exact name" in answer.err
    assert terminal.ros2("topic", "info", "/robot_name").out.splitlines()[1] == "Publisher count: 4"
