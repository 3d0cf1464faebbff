"""Where in an author's file something was made, for messages that name the line."""

from __future__ import annotations

import sys

#: The file in which an author declares scenarios.
AUTHORS_FILE = "scenarios.py"


def line_of_the_author() -> int:
    """The line of the innermost call in a scenarios.py, or 0 outside of one."""
    frame = sys._getframe(1)
    while frame is not None:
        if frame.f_code.co_filename.endswith(f"/{AUTHORS_FILE}"):
            return frame.f_lineno
        frame = frame.f_back  # type: ignore[assignment]  # None at the end
    return 0
