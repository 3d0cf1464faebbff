"""Why there is no program to run: something that nobody can read, or a choice that nobody but a person can make."""

from __future__ import annotations

import re


class Unreadable(Exception):
    """Raised when there is no program in what was handed in; the text tells the student why, and what to do."""


class AmbiguousProgram(Exception):
    """Raised when several different programs could be meant and nothing tells which: a question, never a score."""


_BEGIN = re.compile(rb"^<{7}(?: .*)?$", re.MULTILINE)
_END = re.compile(rb"^>{7}(?: .*)?$", re.MULTILINE)


def merge_conflict(content: bytes) -> int:
    """Return the line of the first mark that git leaves where two versions conflict; 0 if there is none."""
    begin = _BEGIN.search(content.replace(b"\r\n", b"\n"))
    return content.count(b"\n", 0, begin.start()) + 1 if begin and _END.search(content.replace(b"\r\n", b"\n")) else 0
