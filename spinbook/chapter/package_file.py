"""Titles of fences that are a package's launch or parameter files, such as `launch/humanoid.launch.py`."""

from __future__ import annotations

import ast
import re

from spinbook.ros2.launch.python_file import MODULES

_PATH = re.compile(r"launch/[\w-]+[._]launch\.(py|yaml|yml|xml)|config/[\w-]+\.ya?ml")


def is_package_file(title: str) -> bool:
    """Whether a title is the path of a launch or parameter file within a package.

    >>> is_package_file("launch/humanoid.launch.py"), is_package_file("joint_publisher.py")
    (True, False)
    """
    return bool(_PATH.fullmatch(title))


def unsupported_in_launch_file(code: str) -> str:
    """What a Python launch file imports from ROS 2's launch that there is not here; "" if there is all of it.

    Raises SyntaxError.
    """
    for item in ast.walk(ast.parse(code)):
        if isinstance(item, ast.ImportFrom) and item.module and item.module.split(".")[0] in {"launch", "launch_ros"}:
            there = MODULES.get(item.module, {})
            missing = [name.name for name in item.names if name.name not in there]
            if missing and not all(f"{item.module}.{name}" in MODULES for name in missing):
                return f"{item.module}.{missing[0]}"
        elif isinstance(item, ast.Import):
            for name in item.names:
                if name.name.split(".")[0] in {"launch", "launch_ros"} and name.name not in MODULES:
                    return name.name
    return ""
