"""Makes a student's text harmless for terminals and pictures."""

from __future__ import annotations

import re

#: A student need not know where libraries and the submission are on the grading machine.
PLACES = re.compile(r'(?<=File ")(?:/submission/|[^"\n]*/(?:site|dist)-packages/)')


def as_students_see_it(log: str) -> str:
    """Return a log in whose tracebacks files have the names that their author knows, such as `joint_velocity.py`."""
    return PLACES.sub("", log)


def printable(text: str, longest: int = 0) -> str:
    """`text` with every character that could steer a terminal shown as a replacement sign; line ends and tabs stay.

    With `longest`, only this many characters are kept.
    """
    shown = "".join(c if c.isprintable() or c in "\n\t" else "\N{REPLACEMENT CHARACTER}" for c in text)
    return shown if not longest or len(shown) <= longest else f"{shown[:longest]}…"
