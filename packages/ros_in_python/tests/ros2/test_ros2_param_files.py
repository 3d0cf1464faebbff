"""`ros2 param`: files of parameters, and values that are lists."""

from __future__ import annotations

from pathlib import Path

from ros2_terminal import Robot, Terminal

from ros_in_python.ros2.param import parameters_of_file


def test_a_list_is_shown_as_a_list(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    assert terminal.ros2("param", "get", "/joint_publisher", "gains.left").out == "Double values are: [0.5, 0.25]\n"


def test_a_file_sets_what_a_running_node_accepts_and_says_what_it_refuses(
    robot: Robot, terminal: Terminal, tmp_path: Path
) -> None:
    robot("publisher")
    file = tmp_path / "robot.yaml"
    file.write_text(
        "/joint_publisher: {ros__parameters: {rate: 20}}\n/**: {ros__parameters: {gains.left: [0.75, 1.0]}}\n"
    )
    assert [it.name for it in parameters_of_file(file, "/joint_publisher", use_wildcard=False)] == ["rate"]
    assert [it.name for it in parameters_of_file(file, "/arm", use_wildcard=True)] == ["gains.left"]
    answer = terminal.ros2("param", "load", "/joint_publisher", str(file))
    assert answer.code == 1
    assert answer.out == "Set parameter gains.left successful\n"
    assert answer.err.startswith("Set parameter rate failed: Wrong parameter type")
    assert terminal.ros2("param", "get", "/joint_publisher", "gains.left").out == "Double values are: [0.75, 1.0]\n"


def test_a_file_without_the_node_is_refused_with_the_form_that_it_needs(
    standing: Robot, terminal: Terminal, tmp_path: Path
) -> None:
    standing("publisher")
    for text in ("/arm:\n  ros__parameters:\n    rate: 20.0\n", "", "rate: [\n", "/joint_publisher: 3\n"):
        file = tmp_path / "robot.yaml"
        file.write_text(text)
        answer = terminal.ros2("param", "load", "/joint_publisher", str(file))
        assert (answer.code, answer.out) == (1, "")
        assert "robot.yaml" in answer.err
