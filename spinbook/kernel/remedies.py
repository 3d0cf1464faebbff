"""What to do about an exception in a node: in the words that graded students read, and where the cause is."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from spinbook.chapter.callback_answers import unanswered
from spinbook.kernel.reader_frames import line_of_cell

#: Where rclpy sends what a callback of a service or an action has returned.
_FROM_RCLPY = re.compile(
    r", in (send_response|_send_result_response)$|__(response|result)__convert_from_py", re.MULTILINE
)

#: How advice begins that only helps someone who has the chapter to compare with.
_VAGUE = "The library that this line calls refused"


def remedy(traceback: str, files: Sequence[str]) -> str:
    """Return what to do about an exception in the programs `files`, in a sentence or two; "" if it says enough."""
    # Only after an exception, for these import ROS.
    from grader.runner.error_advice import advice_on
    from grader.runner.tracebacks import last_error

    sources = _sources(files)
    last = last_error(traceback, sources)
    advice = advice_on(last, sources) if last else ""
    return "" if advice.startswith(_VAGUE) else advice


def silent_callback(traceback: str, files: Sequence[str]) -> tuple[str, str, int] | None:
    """Return (what, file, line of its cell) for the callback that ended without its answer, if there is exactly one.

    rclpy's traceback does not name it.
    """
    if not _FROM_RCLPY.search(traceback):
        return None
    causes = [(wrong, file) for file, source in _sources(files).items() for wrong in unanswered(source)]
    if len(causes) != 1:
        return None
    wrong, file = causes[0]
    return wrong.problem.rstrip("."), Path(file).name, line_of_cell(file, wrong.line) or 0


def _sources(files: Sequence[str]) -> dict[str, str]:
    return {file: Path(file).read_text(encoding="utf-8") for file in files if line_of_cell(file, 1) is not None}
