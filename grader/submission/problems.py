"""The reasons why there is no program to run: it can't be read, or it is ambiguous."""

from __future__ import annotations

import re


class Unreadable(Exception):
    """Raised if there is no program in what was handed in; the text tells the student why, and what to do."""


class AmbiguousProgram(Exception):
    """Raised if the student may mean several different programs: a question to the instructor, never a score."""


_BEGIN = re.compile(rb"^<{7}(?: .*)?$", re.MULTILINE)
_END = re.compile(rb"^>{7}(?: .*)?$", re.MULTILINE)


def merge_conflict(content: bytes) -> int:
    """Return the line of git's first conflict marker; 0 if there is none."""
    begin = _BEGIN.search(content.replace(b"\r\n", b"\n"))
    return content.count(b"\n", 0, begin.start()) + 1 if begin and _END.search(content.replace(b"\r\n", b"\n")) else 0
