"""The end of what a student's program printed, made fit for a page."""

from __future__ import annotations

import re

from grader.report.printable import as_students_see_it, printable

LINES, LONGEST_LINE = 40, 400

#: Colours and other orders to a terminal (ECMA-48): they say nothing on a page.
ORDERS = re.compile(r"\x1b(\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(\x07|\x1b\\)?|[ -~])")


def tail(log: str) -> tuple[str, int]:
    """The last 40 lines of `log`, each of 400 characters at most, and how many lines before them are left out."""
    lines = [line.rstrip() for line in log.rstrip().split("\n")]
    kept = [_readable(line[: 10 * LONGEST_LINE]) for line in lines[-LINES:]]
    return "\n".join(kept), len(lines) - len(kept)


def _readable(line: str) -> str:
    return printable(as_students_see_it(ORDERS.sub("", line)), LONGEST_LINE)
