"""`ros2 run` starts the programs of tf2_ros, tf2_tools, robot_state_publisher and joint_state_publisher."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from ros2_terminal import Terminal

ROBOT = """\
<robot name="post"><link name="base"/><link name="arm"/><link name="hand"/>
  <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>
  <joint name="grip" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="2 0 0"/></joint>
</robot>
"""


@pytest.fixture(autouse=True)
def _not_sourced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setenv("RCUTILS_LOGGING_USE_STDOUT", "1")


def test_a_static_transform_is_echoed_with_its_angles_and_matrix(ros_domain: int, terminal: Terminal) -> None:
    words = ("--x", "1", "--yaw", "1.570796", "--frame-id", "world", "--child-frame-id", "camera")
    publisher = terminal.start("run", "tf2_ros", "static_transform_publisher", *words)
    assert "publishing transform" in publisher.lines(1)[0]
    echo = terminal.start("run", "tf2_ros", "tf2_echo", "world", "camera", "20")
    lines: list[str] = []
    while not lines or not lines[-1].startswith("At time"):
        lines += echo.lines(1)
    assert echo.lines(9) == [
        "- Translation: [1.000, 0.000, 0.000]",
        "- Rotation: in Quaternion (xyzw) [0.000, 0.000, 0.707, 0.707]",
        "- Rotation: in RPY (radian) [0.000, 0.000, 1.571]",
        "- Rotation: in RPY (degree) [0.000, 0.000, 90.000]",
        "- Matrix:",
        "   0.000 -1.000  0.000  1.000",
        "   1.000  0.000  0.000  0.000",
        "   0.000  0.000  1.000  0.000",
        "   0.000  0.000  0.000  1.000",
    ]
    assert (echo.stop().code, publisher.stop().code) == (0, 0)


def test_a_robots_frames_follow_from_its_urdf_and_its_joints(
    ros_domain: int, terminal: Terminal, tmp_path: Path
) -> None:
    (tmp_path / "robot.urdf").write_text(ROBOT)
    frames = terminal.start("run", "robot_state_publisher", "robot_state_publisher", "robot.urdf", cwd=tmp_path)
    assert "Robot initialized" in frames.lines(1)[0]
    joints = terminal.start("run", "joint_state_publisher", "joint_state_publisher")
    monitor = terminal.start("run", "tf2_ros", "tf2_monitor")
    lines: list[str] = []
    while not (any("Frame: arm" in line for line in lines) and any("Frame: hand" in line for line in lines)):
        lines += monitor.lines(1)
    assert any(re.fullmatch(r"Frame: hand, published by .*, static", line) for line in lines)
    said = terminal.ros2("topic", "echo", "--once", "/robot_description", "--field", "data")
    assert 'robot name="post"' in said.out
    for program in (monitor, joints, frames):
        assert program.stop().code == 0


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("robot_state_publisher", "robot_state_publisher"), "Give one"),
        (("robot_state_publisher", "robot_state_publisher", "no.urdf"), "no.urdf: No such file"),
        (("tf2_ros", "static_transform_publisher", "--frame-id", "a"), "--child-frame-id"),
        (("tf2_ros", "tf2_monitor", "a"), "no frame, or two"),
    ],
)
def test_wrong_use_is_a_sentence(
    ros_domain: int, terminal: Terminal, tmp_path: Path, words: tuple[str, ...], text: str
) -> None:
    said = terminal.ros2("run", *words, cwd=tmp_path)
    assert said.code not in (0, None)
    assert text in said.err
    assert "Traceback" not in said.err
