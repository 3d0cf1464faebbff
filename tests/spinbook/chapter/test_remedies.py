"""What a chapter lacks is named with a remedy that works, and nothing else is taken for a package."""

from __future__ import annotations

from pathlib import Path

import pytest
from fences import IMPORTS, MAIN, TALKER, reading


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        (
            "from image_geometry import PinholeCameraModel",
            "PyPI does not have ROS 2's: run the course where a ROS installation has it, or",
        ),
        ("from moveit_msgs.msg import RobotState", "PyPI does not have it: show its .msg, .srv and .action files"),
        ("import omni", "It comes only with Isaac Sim: write `static` after the fence's language."),
        ("import whisper", "If PyPI has it, add it to the course's dependencies; otherwise write `static`"),
        ("from geometry_msgs_py import poses", "If PyPI has it, add it"),
        ("from std_msg.msg import String", "Did you mean `std_msgs`?"),
        ("import tf2_geometry_msg", "Did you mean `tf2_geometry_msgs`?"),
        ("from sensor_msgs_py.point_cloud import read_points", "Did you mean `sensor_msgs_py.point_cloud2`?"),
        ("import moveit_commander", "It comes only with ROS 1"),
    ],
)
def test_the_remedy_for_a_missing_package_is_one_that_works(tmp_path: Path, line: str, fix: str) -> None:
    (problem,) = reading(tmp_path, f'```python title="a.py"\n{line}\n{IMPORTS}{TALKER}{MAIN}```\n').problems

    assert problem.line == 4
    assert problem.fix.startswith(fix)


@pytest.mark.parametrize(
    "command",
    [
        "run PACKAGE_NAME NODE_NAME",
        "run package_name node_name",
        "launch {[1] the package} {[2] the file}",
        "run <p> <n>",
    ],
)
def test_placeholders_are_not_packages(tmp_path: Path, command: str) -> None:
    (problem,) = reading(tmp_path, f"```bash\nros2 {command}\n```\n").problems

    assert "it holds placeholders for what a reader fills in" in problem.problem
    assert "write `static` after the language" in problem.fix.lower()
    assert problem.group in {"", "a real shell"}


def test_a_package_that_is_not_here_is_not_said_to_be_installable(tmp_path: Path) -> None:
    (problem,) = reading(tmp_path, "```bash\nros2 run nav2_bringup bringup\n```\n").problems

    assert (
        problem.fix == "Show its program in a fence of the chapter, or run the course where a ROS installation has it."
    )
