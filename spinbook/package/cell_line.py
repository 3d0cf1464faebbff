"""Reads the lines of the notebook's commands: their words, options and usage."""

from __future__ import annotations

import argparse
import re
import shlex
from typing import NoReturn

#: How long a node's log is shown (s).
NODE_SECONDS = 3.0

#: A comment, or what is quoted and so none. As in a shell, it begins where a word would, so `/topic#2` is one word.
_COMMENT = re.compile(r"""("[^"]*"|'[^']*')|(?<!\S)#.*""")


class CellFailed(Exception):
    """Raised by a notebook command. Only its message is shown, but the cell counts as failed everywhere."""

    def _render_traceback_(self) -> list[str]:
        """Return the lines that IPython prints instead of a traceback."""
        return [str(self)]


class LineReader(argparse.ArgumentParser):
    """Parses a magic's line; wrong usage and the text of `--help` are shown in the cell."""

    def __init__(self, prog: str, description: str) -> None:
        super().__init__(prog=prog, description=description, allow_abbrev=False)

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        raise CellFailed(message or "")

    def error(self, message: str) -> NoReturn:
        raise CellFailed(f"{message}\n{self.format_usage().rstrip()}")

    def read(self, line: str) -> argparse.Namespace | None:
        """Return the arguments, or None if the help was requested and has been printed. Raises CellFailed."""
        words = split(line)
        if "-h" in words or "--help" in words:
            print(self.format_help())
            return None
        return self.parse_args(words)


def split(line: str) -> list[str]:
    """Return the words of a line, quoted as in a shell and without a `# comment`. Raises CellFailed."""
    try:
        return shlex.split(_COMMENT.sub(r"\1", line))
    except ValueError as error:
        raise CellFailed(f"can't read this line: {error}. A quotation mark is missing in: {line}") from None


def chapter_reader() -> LineReader:
    """Return what reads a `%chapter` line."""
    reader = LineReader("%chapter", "Set this notebook's chapter, and the package of its nodes.")
    reader.add_argument("name")
    reader.add_argument("--package", default="notebook_nodes")
    reader.add_argument("--workspace", default="notebook_ws")
    return reader


def node_reader() -> LineReader:
    """Return what reads the line of a `%%node` cell."""
    reader = LineReader("%%node", "Run this cell as a node, in its own process. Running it again restarts it.")
    reader.add_argument("name", help="the node's file, without .py")
    reader.add_argument("--seconds", type=float, default=NODE_SECONDS, help="how long its log is shown")
    reader.add_argument("--until", help="stop showing the log once it contains this text")
    reader.add_argument(
        "--class",
        dest="classes",
        action="append",
        default=[],
        help="run this Node class with rclpy.spin, or call CLASS.METHOD",
    )
    reader.add_argument("--main", action="store_true", help="call main(), because the code does not call it")
    reader.add_argument("--after", nargs="+", default=[], metavar="CELL", help="use what these nodes and parts define")
    reader.add_argument("--usual-imports", action="store_true", help="add the imports that the code leaves out")
    reader.add_argument("--keep", action="store_true", help="only save it, for `%%ros2 run` to start with words")
    reader.add_argument(
        "--as",
        dest="known_as",
        action="append",
        default=[],
        metavar="PACKAGE/EXECUTABLE",
        help="the name of this node for `ros2 run`",
    )
    reader.add_argument("--of", metavar="CHAPTER", help="only save this program, which another chapter shows")
    reader.add_argument("--replaces", metavar="NODE", help="stop this node first: it is an earlier version")
    reader.add_argument("--expect-error", action="store_true", help="its errors are meant: do not report them")
    return reader
