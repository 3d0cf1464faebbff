"""Tracebacks as readers need them: only frames of their own code, with paths that are the same on every machine."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

_LAUNCHED = r"(?P<launched>\[[\w./-]+-\d+\] )?"
_BEGIN = re.compile(_LAUNCHED + r"\s*Traceback \(most recent call last\):$")
_FRAME = re.compile(_LAUNCHED + r'(?P<before>\s+File ")(?P<file>[^"]+)(?P<then>", line )(?P<line>\d+)(?P<after>.*)')
#: In a node's file, the comment in the place of the cell's magic; with the magic's line if that is another one.
_MAGIC = re.compile(r"# %%node \S+(?: \(line (?P<line>\d+)\))?")
_INDENTED = re.compile(_LAUNCHED + r"\s")


_LOG_LINE = re.compile(_LAUNCHED + r"\[(DEBUG|INFO|WARN|ERROR|FATAL)\] ")


def magic_comment(name: str, line: int) -> str:
    """Return the line of a node's file that stands for its cell's magic, which is in this line of the cell."""
    return f"# %%node {name} (line {line})" if line else f"# %%node {name}"


def line_of_cell(file: str, line: int) -> int | None:
    """Return the line of its cell for a line of a node's file: 0 if it is above it, None if no cell made the file."""
    try:
        lines = Path(file).read_text(encoding="utf-8").split("\n")
    except (OSError, ValueError):
        return None
    magics = ((number, match) for number, text in enumerate(lines, 1) if (match := _MAGIC.fullmatch(text)))
    number, match = next(magics, (0, None))
    return None if match is None else max(line - number + int(match["line"] or number), 0) if line >= number else 0


def is_log_line(line: str) -> bool:
    """Return whether a line is one of ROS's log, which another thread may write in the middle of a traceback."""
    return bool(_LOG_LINE.match(line))


class ReaderFrames:
    """Goes through the lines of an output in order, and leaves out frames of files that are not below this folder."""

    def __init__(self) -> None:
        self._root = Path.cwd()
        self._inside = False
        self._keeps = True

    def shown(self, lines: Iterable[str]) -> Iterator[str]:
        """Yield those of the next lines that are shown."""
        for line in lines:
            shown = self._line(line)
            if shown is not None:
                yield shown

    def _line(self, line: str) -> str | None:
        if _BEGIN.match(line):
            self._inside, self._keeps = True, True
        elif (frame := _FRAME.match(line)) and (self._inside or self._of_reader(frame["file"])):  # or a SyntaxError
            file = self._of_reader(frame["file"])
            self._keeps = bool(file)
            place = f"{file}{frame['then']}{_in_cell(frame['file'], int(frame['line']))}"
            return f"{frame['launched'] or ''}{frame['before']}{place}{frame['after']}" if file else None
        elif self._inside and _INDENTED.match(line):
            return line if self._keeps else None
        else:
            self._inside = self._inside and is_log_line(line)
        return line

    def _of_reader(self, name: str) -> str:
        """Return a file's path for the reader; "" if it is a library's."""
        if name.startswith("<"):
            return "" if name.startswith("<frozen") else name
        file = Path(name)
        # What `colcon build` has installed for the reader is theirs; the script that starts it is not.
        is_library = file.is_relative_to(sys.prefix) or file.suffix != ".py"
        return os.path.relpath(file, self._root) if file.is_relative_to(self._root) and not is_library else ""


def _in_cell(file: str, line: int) -> str:
    """Return the line to show: that of the cell, as the notebook counts it."""
    shown = line_of_cell(file, line)
    return f"{line} above its cell" if shown == 0 else str(shown or line)


def readable(text: str) -> str:
    """Return a whole output with the reader's frames only."""
    return "\n".join(ReaderFrames().shown(text.split("\n")))
