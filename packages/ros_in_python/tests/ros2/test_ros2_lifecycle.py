"""`ros2 lifecycle`: the state of nodes with a life cycle, and its changes."""

from __future__ import annotations

import pytest
from ros2_terminal import Robot, Terminal

pytestmark = pytest.mark.usefixtures("ros_domain")


def test_a_node_is_found_configured_and_says_what_it_can_do(robot: Robot, terminal: Terminal) -> None:
    robot("lifecycle", "service")
    assert terminal.ros2("lifecycle", "nodes").out == "/camera\n"
    assert terminal.ros2("lifecycle", "get", "camera").out == "unconfigured [1]\n"
    assert terminal.ros2("lifecycle", "list", "/camera").out == (
        "- configure [1]\n\tStart: unconfigured\n\tGoal: configuring\n"
        "- shutdown [5]\n\tStart: unconfigured\n\tGoal: shuttingdown\n"
    )
    assert terminal.ros2("lifecycle", "set", "/camera", "configure").out == "Transitioning successful\n"
    assert terminal.ros2("lifecycle", "get").out == "/camera: inactive [2]\n"
    assert len(terminal.ros2("lifecycle", "list", "-a", "/camera").out.splitlines()) > 30

    failed = terminal.ros2("lifecycle", "set", "/camera", "activate")
    assert (failed.code, failed.err.splitlines()[0]) == (1, "Transitioning failed")
    wrong = terminal.ros2("lifecycle", "set", "/camera", "configure")
    assert wrong.code == 1
    assert "- cleanup [2]" in wrong.err
    assert "The node is inactive [2]." in wrong.err
    other = terminal.ros2("lifecycle", "get", "/stander")
    assert (other.code, other.err.splitlines()[0]) == (1, "Node not found")
    assert "/camera" in other.err
