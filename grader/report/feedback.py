"""One student's feedback page: outcomes, findings and the end of the log."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass
from html import unescape
from typing import TYPE_CHECKING

from grader.exercise.exercise import Exercise
from grader.recording.printed_paths import without_paths
from grader.report.checks import shown_checks
from grader.report.pages import render
from grader.report.printable import printable

if TYPE_CHECKING:  # which needs a sandbox, and a web page has none
    from grader.grading.grade import Entry, Grade, Outcome


@dataclass(frozen=True)
class Advice:
    """A headline, what it means in a sentence, and steps to take."""

    headline: str
    meaning: str
    steps: tuple[str, ...]


HEADLINES: dict[Outcome, tuple[str, str]] = {
    "graded": ("", ""),
    "did-not-start": ("Your program did not start", "It ended before it created a node, so no check could be passed."),
    "crashed": (
        "Your program crashed",
        "It started well and ended by itself in the very first scenario, so no check could be passed.",
    ),
    "timed-out": (
        "Your node stopped answering",
        "It was started, but hung in the very first scenario, so no check could be passed. A busy machine is not the "
        "reason: only your node's own time counts.",
    ),
    "over-limit": (
        "Your program exceeded a limit",
        "It was stopped in the very first scenario, so no check could be passed.",
    ),
    "host-error": (
        "This could not be graded, and that is not your fault",
        "The machine or the grader was at fault. This is not a score, and it costs you nothing.",
    ),
    "missing": ("Nothing was handed in", "There is no submission of yours, so there are no points."),
    "undecided": (
        "Not graded yet",
        "There are several submissions of yours. Your instructor decides which one counts.",
    ),
}


def advice(grade: Grade, exercise: Exercise) -> Advice | None:
    """Return the message for an outcome other than a plain grade; None for a plain grade."""
    headline, meaning = HEADLINES[grade.outcome]
    if not headline:
        return None
    line = f" Look at line {grade.line} first." if grade.line else ""
    printed = " What your program printed is shown below." if grade.log.strip() else ""
    again = f"Run it yourself: python3 {exercise.file_name}"
    fed = ", with a publisher in another terminal" if exercise.inputs else ""
    steps: dict[Outcome, tuple[str, ...]] = {
        "did-not-start": (f"Read the message above.{line}{printed}", f"{again}. It must start without an error."),
        "crashed": (f"Read the message above.{line}{printed}", f"{again}{fed}."),
        "timed-out": (
            "Look for an endless loop, for a sleep in a callback, and for a missing rclpy.spin(node).",
            f"{again}{fed}. It must answer each message at once." if fed else f"{again}.",
        ),
        "over-limit": (
            "Look for things that are created again and again: timers, messages, files, threads, processes.",
            f"{again}, and watch it with top.",
        ),
        "host-error": ("There is nothing for you to do: it will be graded again.",),
        "missing": ("If you did hand something in, tell your instructor.",),
        "undecided": ("If you know which one counts, tell your instructor.",),
    }
    return Advice(headline, meaning, steps[grade.outcome])


LINES, LONGEST_LINE = 40, 400

#: Colours and other terminal control sequences (ECMA-48), which mean nothing on a page.
ORDERS = re.compile(r"\x1b(\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(\x07|\x1b\\)?|[ -~])")


def tail(log: str) -> tuple[str, int]:
    """Return the last 40 lines of `log`, each of 400 characters at most, and the number of lines before them."""
    lines = [line.rstrip() for line in log.rstrip().split("\n")]
    lines_shown = (without_paths(ORDERS.sub("", line[: 10 * LONGEST_LINE])) for line in lines[-LINES:])
    kept = [printable(line, LONGEST_LINE) for line in lines_shown]
    return "\n".join(kept), len(lines) - len(kept)


KINDS: dict[str, str] = {"late": "Late", "override": "Changed by your instructor", "extra": "Extra credit"}


def feedback_page(entry: Entry, exercise: Exercise, plot_svg: str | None) -> str:
    """Return the page that shows one student the score, every check, and what to do next, as one HTML file.

    It needs no network and runs no script. `plot_svg` is what `feedback_plot` drew, or None for a page without a plot.
    The page shows no more of hidden checks than this module allows. Everything that a student can choose (names,
    messages, output) is shown only as text.
    """
    grade = entry.grade
    checks = shown_checks(grade)
    log, left_out = tail(grade.log)
    return render(
        "report/feedback.html",
        entry=entry,
        student=entry.student.name or entry.student.id,
        exercise=exercise,
        grade=grade,
        advice=advice(grade, exercise),
        public=[check for check in checks if not check.hidden],
        hidden=[check for check in checks if check.hidden],
        first=next((check for check in checks if check.status == "failed" and (check.finding or check.hints)), None),
        adjustments=[(KINDS.get(adjustment.kind, adjustment.kind), adjustment) for adjustment in entry.adjustments],
        plot=_picture(plot_svg) if plot_svg else "",
        plot_says=described(plot_svg) if plot_svg else "",
        log=log,
        left_out=left_out,
        passed=sum(check.status == "passed" for check in checks),
        count=len(checks),
        share=_share(entry),
    )


def _share(entry: Entry) -> float:
    return 0.0 if not entry.final or not entry.grade.points else min(100.0, 100 * entry.final / entry.grade.points)


def _picture(svg: str) -> str:
    """Return the SVG as an image: that way it can neither run nor load anything, whatever it contains."""
    return "data:image/svg+xml;base64," + base64.b64encode(svg.encode("utf-8", "replace")).decode()


def described(svg: str) -> str:
    """Return the picture's own description in <desc>."""
    match = re.search(r"<desc[^>]*>([^<]*)</desc>", svg)
    return unescape(match[1]).strip() if match else "Your node's output drawn over the solution's."
