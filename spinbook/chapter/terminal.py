"""A shell fence: the commands in it, and whether a notebook can run them.

A notebook runs `ros2 …`, `colcon …` and `rqt_plot …`. Moving about (`cd`, `source`, `export`) is what a person does
in a terminal before them; in a notebook it is not needed and stays as a comment. Anything else is shown and not run.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

#: What `ros2` can do without a ROS installation: noun -> verbs. `run` takes no verb.
ROS2 = {
    "topic": {"list", "echo", "hz", "bw", "delay", "info", "pub", "type", "find"},
    "node": {"list", "info"},
    "interface": {"show", "list", "package", "packages", "proto"},
    "service": {"list", "call", "type", "find", "info"},
    "action": {"list", "info", "send_goal", "type"},
    "param": {"list", "get", "set", "describe", "dump", "delete"},
    "pkg": {"list", "executables", "prefix"},
    "daemon": {"status", "start", "stop"},
    "run": set(),
}
_MOVING_ABOUT = frozenset({"cd", "source", ".", "export", "unset", "clear"})
_SHELL_SYNTAX = re.compile(r"[|;<>`]|&&|\$\(|(?<!\S)&(?!\S)|&$")


class CommandKind(Enum):
    """What runs a command in a notebook."""

    ROS2 = "ros2"
    COLCON = "colcon"
    PLOT = "rqt_plot"
    NOTE = "note"


@dataclass(frozen=True)
class Command:
    """One command (or comment) of a shell fence, with continued lines joined. `line` counts from 1 within the fence."""

    kind: CommandKind
    text: str
    words: tuple[str, ...]
    line: int


@dataclass(frozen=True)
class NotRunnable:
    """A command that a notebook can't run, and why."""

    text: str
    line: int
    why: str


def read_commands(code: str) -> list[Command | NotRunnable]:
    """The commands of a shell fence, in order."""
    return [_read(text, line) for text, line in _logical_lines(code)]


def _logical_lines(code: str) -> Iterator[tuple[str, int]]:
    """Each command with its prompt taken off, lines joined that end in a backslash or inside quotes."""
    joined, start = "", 0
    for number, raw in enumerate(code.split("\n"), start=1):
        if not joined:
            start = number
            joined = re.sub(r"^\s*\$\s+", "", raw).strip()
        else:
            joined += "\n" + raw if _inside_quotes(joined) else " " + raw.strip()
        if joined.endswith("\\"):
            joined = joined[:-1].rstrip()
        elif joined and not (_inside_quotes(joined) and not joined.startswith("#")):
            yield joined, start
            joined = ""
    if joined:
        yield joined, start


def _inside_quotes(text: str) -> bool:
    try:
        shlex.split(text)
    except ValueError:
        return True
    return False


def _read(text: str, line: int) -> Command | NotRunnable:
    if text.startswith("#"):
        return Command(CommandKind.NOTE, text, (), line)
    try:
        words = tuple(shlex.split(text, comments=True))
    except ValueError:
        return NotRunnable(text, line, "a quotation mark is never closed")
    outside_quotes = re.sub(r"\"[^\"]*\"|'[^']*'", "", text)
    program = words[0]
    if program in _MOVING_ABOUT:
        return Command(CommandKind.NOTE, f"# {text}", (), line)
    if program not in {"ros2", "colcon", "rqt_plot"}:
        return NotRunnable(text, line, f"`{program}` is none of ros2, colcon and rqt_plot")
    if _SHELL_SYNTAX.search(outside_quotes):
        return NotRunnable(text, line, "pipes, `;`, `&` and redirections need a real shell")
    if program == "ros2":
        return _ros2(text, words, line)
    kind = CommandKind.COLCON if program == "colcon" else CommandKind.PLOT
    return Command(kind, text, words, line)


def _ros2(text: str, words: tuple[str, ...], line: int) -> Command | NotRunnable:
    noun = words[1] if len(words) > 1 else ""
    if noun not in ROS2:
        return NotRunnable(text, line, f"`ros2 {noun}` is none of: {', '.join(ROS2)}")
    verb = words[2] if len(words) > 2 else ""
    if ROS2[noun] and verb not in ROS2[noun] and not verb.startswith("-"):
        return NotRunnable(text, line, f"`ros2 {noun} {verb}` is none of: {', '.join(sorted(ROS2[noun]))}")
    return Command(CommandKind.ROS2, text, words, line)
