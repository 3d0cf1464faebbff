"""Handing over to the `ros2` of a ROS installation, where there is one."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path

from spinbook.ros2 import prefixes
from spinbook.ros2.bootstrap import without_bootstrap
from spinbook.ros2.executables import is_built_in

#: What the script of this command has in it, in whichever environment it is installed.
OURS = b"spinbook.ros2"

#: Runs the `ros2` of this very environment where its script is not: conda's, over which pip has written ours.
AS_MODULE = "import sys; from ros2cli.cli import main; sys.argv[0] = 'ros2'; sys.exit(main())"

#: `own` here keeps this package's command even where the real one is installed.
CHOICE = "SPINBOOK_ROS2"


def real_ros2(arguments: Sequence[str], environment: Mapping[str, str]) -> list[str] | None:
    """Return the command that should answer `arguments` instead of this package, without them, or None."""
    if environment.get(CHOICE) == "own" or _ours_all_the_same(arguments):
        return None
    for folder in environment.get("PATH", os.defpath).split(os.pathsep):
        path = shutil.which("ros2", path=folder)
        if path is not None and not _is_ours(Path(path)):
            return [path]
    return [sys.executable, "-c", AS_MODULE] if find_spec("ros2cli") else None


def _is_ours(script: Path) -> bool:
    """Tell whether this `ros2` is the one that installing Spinbook writes."""
    try:
        with script.open("rb") as file:
            return OURS in file.read(2000)
    except OSError:
        return False


def hand_over(arguments: Sequence[str]) -> None:
    """Become the real `ros2` if it is installed; return if not."""
    command = real_ros2(arguments, os.environ)
    if command is None:
        return
    sys.stdout.flush()
    sys.stderr.flush()
    # Should that `ros2` be a wrapper around this command, it must not come here a second time.
    os.execve(command[0], [*command, *arguments], without_bootstrap(os.environ) | {CHOICE: "own"})


def _ours_all_the_same(arguments: Sequence[str]) -> bool:
    """Whether this runs turtlesim where turtlesim is not installed, which is our own node then."""
    if not arguments or arguments[0] != "run":
        return False
    rest = list(arguments[1:])
    while rest and rest[0].startswith("-"):
        takes_value = rest[0] == "--prefix"
        rest = rest[2 if takes_value else 1 :]
    return rest[:1] == ["turtlesim"] and is_built_in("turtlesim", prefixes.prefix_of("turtlesim", prefixes.installed()))
