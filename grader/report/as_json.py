"""Grades and gradebook entries as JSON: our own form, and Gradescope's.

An entry is `results/STUDENT/grade.json`; docs/grade.schema.json describes it for other programs. Gradescope's
results.json is described in https://gradescope-autograders.readthedocs.io/en/latest/specs/.
"""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

from grader.grading.grade import Entry, Grade
from grader.recording.arrays import LongArray
from grader.report.checks import ShownCheck, shown_checks
from grader.report.feedback import tail
from grader.report.printable import printable
from groundwork.files import read_kept
from groundwork.plain_data import restored


def as_json(grade: Grade) -> str:
    """Return the grade as JSON text: every field but the recordings, always in the same order."""
    entries = {
        field.name: getattr(grade, field.name)
        for field in dataclasses.fields(grade)
        if field.name not in ("recordings", "references", "verdicts")
    }
    entries["verdicts"] = [dataclasses.asdict(verdict) | {"earned": verdict.earned} for verdict in grade.verdicts]
    return json.dumps(_finite(entries), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    """Replace NaN and infinity, which JSON can't express."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, LongArray)):
        return [_finite(item) for item in value]
    return value


#: The folder in a class's results that holds one folder per student. Without it, a student's name could be that of one
#: of our files: a submission `index.html.py` is from a student `index.html`.
STUDENTS = "students"


def folder_of(results: Path, student_id: str) -> Path:
    """Return the folder of one student in a class's folder of results."""
    return results / STUDENTS / student_id


def to_json(entry: Entry, key: str = "") -> str:
    """Return `entry` as a text from which `from_json` makes an equal one, except for recordings.

    `key` is a digest of what the grade depends on. While it stays the same, the grade is not made again.
    """
    entries: dict[str, Any] = {
        "student": vars(entry.student),
        "file": entry.file,
        "submitted": entry.submitted.isoformat() if entry.submitted else None,
        "submitted_from": entry.submitted_from,
        "final": entry.final,
        "adjustments": [vars(adjustment) for adjustment in entry.adjustments],
        "grade": json.loads(as_json(entry.grade)),
        "key": key,
    }
    return json.dumps(entries, indent=2, ensure_ascii=False) + "\n"


def read_grade(file: Path) -> tuple[Entry, str] | None:
    """Return the entry and the key of what `to_json` wrote into this file; None if it is missing or holds anything
    else.
    """
    return read_kept(file, _grade_in)


def _grade_in(content: bytes) -> tuple[Entry, str]:
    entries = json.loads(content)
    key = str(entries.pop("key"))
    # What follows from the rest is there for other programs.
    del entries["final"]
    for verdict in entries["grade"]["verdicts"]:
        del verdict["earned"]
    return restored(Entry, entries), key


LONGEST_TEXT = 20_000

VISIBLE, AFTER_PUBLISHED, HIDDEN = "visible", "after_published", "hidden"


def gradescope_results(entry: Entry) -> dict[str, Any]:
    """Return the results for Gradescope: public checks visible at once, hidden ones when grades are published.

    The output is never visible to students. Hidden checks contain as little as the feedback page shows
    (`grader.report.feedback`), because students read them once grades are published. A fault of ours has no score and
    no tests: Gradescope then records no score.
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
    """Return the results for Gradescope if a fault of ours prevented grading: a text, and no score."""
    text = f"This could not be graded, and that is not your fault. Tell your instructor.\n{message}"
    return {"output": _text(text), "output_format": "text", "stdout_visibility": HIDDEN}


def results_json(entry: Entry) -> str:
    """Return `gradescope_results` as JSON text."""
    return json.dumps(gradescope_results(entry), indent=2, ensure_ascii=False) + "\n"


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
