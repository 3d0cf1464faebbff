"""One student's page."""

from __future__ import annotations

import base64
import re
from html import unescape

from grader.classroom.entry import Adjustment, Entry
from grader.exercise import Exercise
from grader.feedback.log import tail
from grader.feedback.outcomes import advice
from grader.feedback.told import told
from grader.pages import render

KINDS: dict[str, str] = {"late": "Late", "override": "Changed by your instructor", "extra": "Extra credit"}


def feedback_page(entry: Entry, exercise: Exercise, plot_svg: str | None) -> str:
    """The page that tells one student the score, every check, and what to do next, as one HTML file.

    It needs no network and runs no script. `plot_svg` is what `feedback_plot` drew, or None for a page without a plot.
    Of hidden checks it tells no more than `grader.feedback.told` allows. Everything that a student can choose (names,
    messages, output) is shown as text and nothing else.
    """
    grade = entry.grade
    checks = told(grade)
    log, left_out = tail(grade.log)
    return render(
        "feedback/feedback.html",
        entry=entry,
        student=entry.student.name or entry.student.id,
        exercise=exercise,
        grade=grade,
        advice=advice(grade, exercise),
        public=[check for check in checks if not check.hidden],
        hidden=[check for check in checks if check.hidden],
        first=next((check for check in checks if check.status == "failed" and (check.finding or check.hint)), None),
        adjustments=[(_kind(adjustment), adjustment) for adjustment in entry.adjustments],
        plot=_picture(plot_svg) if plot_svg else "",
        plot_says=_description(plot_svg) if plot_svg else "",
        log=log,
        left_out=left_out,
        passed=sum(check.status == "passed" for check in checks),
        count=len(checks),
        share=_share(entry),
    )


def _kind(adjustment: Adjustment) -> str:
    return KINDS.get(adjustment.kind, adjustment.kind)


def _share(entry: Entry) -> float:
    return 0.0 if not entry.final or not entry.grade.points else min(100.0, 100 * entry.final / entry.grade.points)


def _picture(svg: str) -> str:
    """As an image an SVG can neither run anything nor load anything, whatever is in it."""
    return "data:image/svg+xml;base64," + base64.b64encode(svg.encode("utf-8", "replace")).decode()


def _description(svg: str) -> str:
    """What the picture says of itself in <desc>."""
    found = re.search(r"<desc[^>]*>([^<]*)</desc>", svg)
    return unescape(found[1]).strip() if found else "Your node's output drawn over the solution's."
