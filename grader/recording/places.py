"""Maps lines of an assembled program to the notebook's cells.

In a program that was assembled from a notebook's cells, a comment above each piece names its cell.
"""

from __future__ import annotations

import re

_MARKED = re.compile(r"# --- code cell (?P<cell>\d{1,9}), from line (?P<line>\d{1,9}) ---")

#: The first line of a file that Spinbook adds to start a module of the submission.
LAUNCHER = "# Starts a module of the submission, as its installed executable would."


def mark(cell: int, line: int) -> str:
    """Return the comment above a piece that begins at this line of this code cell."""
    return f"# --- code cell {cell}, from line {line} ---"


def place_of(source: str, line: int) -> tuple[int, int]:
    """Return (code cell, line in it) for a line of an assembled program; (0, line) for any other program."""
    for above, text in enumerate(reversed(source.split("\n")[:line])):
        if match := _MARKED.fullmatch(text.strip()):
            return int(match["cell"]), int(match["line"]) + above - 1
    return 0, line


def without_marks(code: str) -> str:
    """Return a program without the comments that name its cells."""
    return "\n".join(line for line in code.split("\n") if not _MARKED.fullmatch(line.strip()))


def is_launcher(text: str) -> bool:
    """Return whether a file is a launcher that Spinbook added, and not the student's."""
    return text.startswith(LAUNCHER)
