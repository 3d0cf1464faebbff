"""Cells that are not nodes: plain Python, and a terminal's `ros2 …`. They share one process."""

from __future__ import annotations

import ast
import os
import shlex
import signal
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from spinbook.browser.in_page import program_imports
from spinbook.browser.in_page.process import status_of

_variables: dict[str, Any] = {"__name__": "__main__"}


def run_python(source: str) -> int:
    """Run a plain cell and print the value of its last expression, as a notebook does; return its exit status."""
    with program_imports.programs_turn():
        return status_of(lambda: _run(source))


def _run(source: str) -> None:
    tree = ast.parse(source, "<cell>")
    last = tree.body[-1] if tree.body else None
    if isinstance(last, ast.Expr):
        tree.body.pop()
    exec(compile(tree, "<cell>", "exec"), _variables)
    if isinstance(last, ast.Expr):
        value = eval(compile(ast.Expression(last.value), "<cell>", "eval"), _variables)
        if value is not None:
            print(repr(value))


def set_environment(environment: Mapping[str, str]) -> None:
    """Set the variables that `%env` and `export` have set in the page."""
    os.environ.update(environment)


def commands(source: str) -> list[dict[str, Any]]:
    """Read a terminal cell's commands as a chapter's are read: kind, words and text, or why it can't run."""
    from spinbook.chapter.terminal import Command, UnsupportedCommand, read_commands

    def as_data(item: Command | UnsupportedCommand) -> dict[str, Any]:
        if isinstance(item, Command):
            return {"kind": item.kind.value, "words": item.words, "text": item.text}
        if item.is_unknown:  # `ros2` itself says what there is
            return {"kind": "ros2", "words": item.text.split(), "text": item.text}
        return {"text": item.text, "why": f"{item.why}. Did you mean `{item.meant}`?" if item.meant else f"{item.why}."}

    return [as_data(item) for item in read_commands(source)]


_SHARE = Path("/opt/ros/share")
_OTHER_TEXT = (
    "This text is not the one that the page's classes were made of. A page can't compile interfaces: "
    "press Reset, or change it in the notebook."
)


def define(path: str, text: str) -> int:
    """Make an interface of the chapter (`PACKAGE/msg/NAME.msg`) available; return 1 if its text was changed."""
    file = _SHARE / path
    if not file.is_file() or file.read_text(encoding="utf-8").strip() != text.strip():
        print(_OTHER_TEXT, file=sys.stderr)
        return 1
    package, kind, name = path.split("/")
    print(f"{package}/{kind}/{name.partition('.')[0]}: ready.")
    return 0


def run_command(line: str) -> int:
    """Run one `ros2 …` of a terminal; return its exit status."""
    os.environ["ROS_IN_PYTHON"] = "own"
    # One command changes the signal handlers, and the next expects them unchanged.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    words = shlex.split(line)
    status = status_of(lambda: _ros2(words[1:]))
    signal.signal(signal.SIGINT, signal.default_int_handler)
    return status


def _ros2(words: Sequence[str]) -> None:
    from ros_in_python.ros2.command import ros2

    ros2(list(words), prog_name="ros2")
