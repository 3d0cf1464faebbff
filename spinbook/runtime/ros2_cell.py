"""`%ros2`: a terminal's `ros2 …` in a cell. What does not end by itself is ended after a while; `run` goes on."""

from __future__ import annotations

import sys
from pathlib import Path

from spinbook.runtime.failure import CellFailed
from spinbook.runtime.session import Session
from spinbook.runtime.showing import Bound


def run(session: Session, words: list[str], bound: Bound) -> None:
    """Run a `ros2` command, for no longer than its bound. Raises CellFailed where it fails."""
    if words[:1] == ["run"] and not {"-h", "--help"} & set(words):
        _run_executable(session, words[1:], bound)
        return
    argv = [sys.executable, "-m", "spinbook.ros2", *words]
    session.run_command(argv, {}, Path.cwd(), bound, "ros2 " + " ".join(words[:2]))


def _run_executable(session: Session, words: list[str], bound: Bound) -> None:
    """`ros2 run PACKAGE EXECUTABLE …`: a node like any other of the notebook, named for its executable."""
    if len(words) < 2 or words[0].startswith("-"):
        raise CellFailed("Write: ros2 run PACKAGE EXECUTABLE, such as ros2 run turtlesim turtlesim_node")
    executable = words[1]
    argv = [sys.executable, "-m", "spinbook.ros2", "run", *words]
    cwd = session.workspace if session.workspace.is_dir() else Path.cwd()
    session.run_background(executable, argv, {}, cwd, bound)
