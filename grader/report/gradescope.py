"""A grade as Gradescope's results.json.

The form is in https://gradescope-autograders.readthedocs.io/en/latest/specs/.
"""

from __future__ import annotations

import json
from typing import Any

from grader.grading.entry import Entry
from grader.report.feedback import ShownCheck, shown_checks, tail
from grader.report.printable import printable

LONGEST_TEXT = 20_000

VISIBLE, AFTER_PUBLISHED, HIDDEN = "visible", "after_published", "hidden"


def results(entry: Entry) -> dict[str, Any]:
    """What Gradescope is told: public checks visible at once, hidden ones when grades are published, stdout never.

    Of hidden checks it is told as little as the feedback page tells (`grader.report.feedback`), for once grades are
    published students read it. A fault of ours is told with no score and no tests: Gradescope then records no score.
    """
    grade = entry.grade
    if entry.final is None:
        return no_score(grade.message)
    return {
        "score": round(entry.final, 2),
        "execution_time": round(grade.seconds),
        "output": _text(_summary(entry)),
        "output_format": "text",
        "stdout_visibility": HIDDEN,
        "tests": [_test(check) for check in shown_checks(grade)],
        "extra_data": {"outcome": grade.outcome, "isolation": grade.isolation, "versions": grade.versions},
    }


def no_score(message: str) -> dict[str, Any]:
    """What Gradescope is told where nothing could be graded by a fault of ours: a text, and no score."""
    text = f"This could not be graded, and that is not your fault. Tell your instructor.\n{message}"
    return {"output": _text(text), "output_format": "text", "stdout_visibility": HIDDEN}


def results_json(entry: Entry) -> str:
    """`results` as JSON text."""
    return json.dumps(results(entry), indent=2, ensure_ascii=False) + "\n"


def _summary(entry: Entry) -> str:
    grade = entry.grade
    lines = [grade.message] if grade.message else []
    if grade.full_marks:
        lines.append("Your node passed every check.")
    lines += [f"{a.points:+g} points: {a.reason}" for a in entry.adjustments]
    log, _ = tail(grade.log)
    if grade.outcome != "graded" and log:
        lines += ["", "The last lines that your program printed:", log]
    return "\n".join(lines)


def _test(check: ShownCheck) -> dict[str, Any]:
    return {
        "name": _text(check.title),
        "name_format": "text",
        "score": check.earned,
        "max_score": check.points,
        "status": "passed" if check.status == "passed" else "failed",
        "output": _text(check.text),
        "output_format": "text",
        "visibility": AFTER_PUBLISHED if check.hidden else VISIBLE,
    }


def _text(text: str) -> str:
    return printable(text, LONGEST_TEXT)
