"""`ros2 lifecycle`: the state of nodes with a life cycle, and its changes."""

from __future__ import annotations

from pathlib import Path

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


LAUNCH = """
import sys
from launch import LaunchDescription
from launch.actions import EmitEvent, LogInfo, RegisterEventHandler, Shutdown
from launch.events import matches_action
from launch_ros.actions import LifecycleNode, LifecycleTransition
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState

def generate_launch_description():
    camera = LifecycleNode(
        executable=sys.executable, arguments=[ROBOT, "lifecycle"], name="camera", namespace="left")
    return LaunchDescription([
        camera,
        RegisterEventHandler(OnStateTransition(
            target_lifecycle_node=camera, start_state="configuring", goal_state="inactive",
            entities=[LogInfo(msg="inactive"), EmitEvent(event=ChangeState(
                lifecycle_node_matcher=matches_action(camera), transition_id=2))])),
        RegisterEventHandler(OnStateTransition(goal_state="unconfigured", entities=[Shutdown()])),
        LifecycleTransition(lifecycle_node_names=["left/camera"], transition_ids=[1]),
    ])
"""


def test_a_launch_file_changes_states_one_after_another(terminal: Terminal, tmp_path: Path) -> None:
    (tmp_path / "a.launch.py").write_text(LAUNCH.replace("ROBOT", repr(str(Path(__file__).with_name("ros2_robot.py")))))
    answer = terminal.ros2("launch", "a.launch.py", cwd=tmp_path)
    assert answer.code == 0
    assert "[INFO] [launch.user]: inactive" in answer.out
