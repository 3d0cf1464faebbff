"""Handing over to the `ros2` of a ROS installation, where there is one."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Mapping, Sequence

from spinbook.ros2 import prefixes
from spinbook.ros2.bootstrap import without_bootstrap
from spinbook.ros2.executables import is_built_in

#: `own` here keeps this package's command even where the real one is installed.
CHOICE = "SPINBOOK_ROS2"


def real_ros2(arguments: Sequence[str], environment: Mapping[str, str]) -> str | None:
    """The path of the `ros2` that should answer `arguments` instead of this package, or None."""
    if environment.get(CHOICE) == "own":
        return None
    path = shutil.which("ros2", path=environment.get("PATH"))
    if path is None or _ours_all_the_same(arguments):
        return None
    return path


def hand_over(arguments: Sequence[str]) -> None:
    """Become the real `ros2` if it is installed; return if not."""
    path = real_ros2(arguments, os.environ)
    if path is None:
        return
    sys.stdout.flush()
    sys.stderr.flush()
    # Should that `ros2` be a wrapper around this command, it must not come here a second time.
    os.execve(path, [path, *arguments], without_bootstrap(os.environ) | {CHOICE: "own"})


def _ours_all_the_same(arguments: Sequence[str]) -> bool:
    """Whether this runs turtlesim where turtlesim is not installed, which is our own node then."""
    if not arguments or arguments[0] != "run":
        return False
    rest = list(arguments[1:])
    while rest and rest[0].startswith("-"):
        takes_value = rest[0] == "--prefix"
        rest = rest[2 if takes_value else 1 :]
    return rest[:1] == ["turtlesim"] and is_built_in("turtlesim", prefixes.prefix_of("turtlesim", prefixes.installed()))
