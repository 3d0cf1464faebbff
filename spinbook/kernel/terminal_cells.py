"""`%ros2` and `%colcon`: a terminal's commands in a cell."""

from __future__ import annotations

import os
import re
import sys
from dataclasses import replace
from pathlib import Path

from ros_in_python.ros2 import create
from spinbook.chapter.own_packages import new_package
from spinbook.kernel.cell_output import DisplayLimit
from spinbook.kernel.session import NodeStart, Session
from spinbook.package.cell_line import CellFailed
from spinbook.package.workspace import without_interfaces, write_package

#: How long a build may take (s).
COLCON_SECONDS = 120.0


def run_colcon(session: Session, words: list[str], bound: DisplayLimit) -> None:
    """Run colcon with these arguments. Raises CellFailed if there is nothing to build, or if the build fails."""
    workspace = session.workspace
    if not (workspace / "src").is_dir():
        raise CellFailed(f"There is nothing to build in {workspace.name} yet: run the chapter's node cells first.")
    # If ROS 2 is from PyPI, this Python's prefix is the underlay, in place of /opt/ros/jazzy.
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    settings = {
        "AMENT_PREFIX_PATH": os.pathsep.join(dict.fromkeys([*prefixes, sys.prefix])),
        # Otherwise setuptools warns of it in each package.
        "PYTHONDONTWRITEBYTECODE": "",
        # It would warn that this prefix has no local_setup script; nothing here needs one.
        "COLCON_LOG_LEVEL": os.environ.get("COLCON_LOG_LEVEL", "error"),
    }
    if words[:1] == ["build"]:
        words = [*words, *without_interfaces(workspace)]
    argv = [sys.executable, "-m", "colcon", "--log-base", os.fspath(workspace / "log"), *words]
    session.run_command(argv, settings, workspace, bound, "colcon")


def run_ros2(session: Session, words: list[str], bound: DisplayLimit) -> None:
    """Run a `ros2` command with a time limit. Raises CellFailed if it fails."""
    if words[:1] == ["run"] and not {"-h", "--help"} & set(words):
        _run_executable(session, words[1:], bound)
        return
    if words[:1] == ["launch"] and not {"-h", "--help", "-s", "--show-args", "--show-arguments"} & set(words):
        _launch(session, words, bound)
        return
    if words[:2] == ["pkg", "create"]:
        _create_package(session, words)
        return
    argv = [sys.executable, "-m", "ros_in_python.ros2", *words]
    session.run_command(argv, {}, _folder(session, words), bound, "ros2 " + " ".join(words[:2]))


def _folder(session: Session, words: list[str]) -> Path:
    """Return where a command runs: in the workspace if it reads files of the package, as in a terminal."""
    reads_files = words[:1] == ["launch"] or words[:2] == ["param", "load"]
    return session.workspace if reads_files and session.workspace.is_dir() else Path.cwd()


def _launch(session: Session, words: list[str], bound: DisplayLimit) -> None:
    """Run `ros2 launch …` in the background, like a node, under the name of its file, such as `humanoid`."""
    files = [word.rpartition("/")[2] for word in words if re.search(r"launch\.(py|ya?ml|xml)$", word)]
    name = files[0].split(".")[0] if files else "launch"
    argv = [sys.executable, "-m", "ros_in_python.ros2", *words]
    session.run_background(name, argv, {}, _folder(session, words), bound)


def _create_package(session: Session, words: list[str]) -> None:
    """Run `ros2 pkg create … NAME`: make an empty package in the workspace, for the chapter's nodes."""
    package = new_package(["ros2", *words])
    if not (name := package.name):
        raise CellFailed("Write: ros2 pkg create --build-type ament_python NAME")
    if name != session.package.name and (session.workspace / "src" / name).exists():
        print(f"The package {name} already exists.")
        return
    folder = write_package(session.workspace, replace(session.package, name=name), [])
    if node := package.node:
        session.save_node(node, create.NODE.format(package=name), NodeStart(known_as=(f"{name}/{node}",)))
    print(f"Created the package {name} in {folder.relative_to(Path.cwd())}")


def _run_executable(session: Session, words: list[str], bound: DisplayLimit) -> None:
    """Run `ros2 run PACKAGE EXECUTABLE …` as a node of the notebook, with that name or the one in `__node:=`."""
    if len(words) < 2 or words[0].startswith("-"):
        raise CellFailed("Write: ros2 run PACKAGE EXECUTABLE, such as ros2 run turtlesim turtlesim_node")
    executable = words[1]
    name = _renamed(words[2:]) or executable
    if session.run_executable(words[0], executable, words[2:], bound, name):
        return
    argv = [sys.executable, "-m", "ros_in_python.ros2", "run", *words]
    cwd = session.workspace if session.workspace.is_dir() else Path.cwd()
    session.run_background(session.instance(name), argv, {}, cwd, bound)


def _renamed(words: list[str]) -> str:
    """Return the node's name in `__node:=NAME` or `__name:=NAME`, which allows a second node of an executable."""
    for word in words:
        option, mark, name = word.partition(":=")
        if mark and option in ("__node", "__name"):
            return name
    return ""
