"""Where a line of a program is from, if the program is not one file as the student wrote it.

Above each piece of a program that was put together from a notebook's cells stands a line that names the cell.
"""

from __future__ import annotations

import re

_MARKED = re.compile(r"# --- code cell (?P<cell>\d{1,9}), from line (?P<line>\d{1,9}) ---")

#: How a file begins that is not the student's: it starts a module of the submission.
LAUNCHER = "# Starts a module of the submission, as its installed executable would."


def mark(cell: int, line: int) -> str:
    """Return the line above a piece that begins in this line of this code cell."""
    return f"# --- code cell {cell}, from line {line} ---"


def place_of(source: str, line: int) -> tuple[int, int]:
    """Return (code cell, line in it) of a line of an assembled program; (0, line) of any other."""
    for above, text in enumerate(reversed(source.split("\n")[:line])):
        if match := _MARKED.fullmatch(text.strip()):
            return int(match["cell"]), int(match["line"]) + above - 1
    return 0, line


def without_marks(code: str) -> str:
    """Return a program without the lines that say where its pieces are from."""
    return "\n".join(line for line in code.split("\n") if not _MARKED.fullmatch(line.strip()))


def is_launcher(text: str) -> bool:
    """Return whether a file is not the student's but starts what is."""
    return text.startswith(LAUNCHER)
