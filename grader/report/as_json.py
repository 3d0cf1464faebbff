"""Grades and gradebook entries as JSON.

An entry is `results/STUDENT/grade.json`; docs/grade.schema.json describes it for other programs.
"""

from __future__ import annotations

import dataclasses
import json
import math
from datetime import datetime
from pathlib import Path
from typing import Any

from grader.checking.verdict import Finding, Verdict
from grader.grading.entry import Adjustment, Entry, Student
from grader.grading.grade import Grade


def as_json(grade: Grade) -> str:
    """The grade as JSON text: every field but the recordings, with the keys always in one order."""
    entries = {
        field.name: getattr(grade, field.name)
        for field in dataclasses.fields(grade)
        if field.name not in ("recordings", "references", "verdicts")
    }
    entries["verdicts"] = [dataclasses.asdict(verdict) | {"earned": verdict.earned} for verdict in grade.verdicts]
    return json.dumps(_finite(entries), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    """JSON has no word for NaN and infinity."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return value


#: The folder in a class's results that holds one folder per student. Nothing that a student is called can be the name
#: of a file of ours beside it: a file `index.html.py` is from a student `index.html`.
STUDENTS = "students"


def folder_of(results: Path, student_id: str) -> Path:
    """Return the folder of one student in a class's folder of results."""
    return results / STUDENTS / student_id


def to_json(entry: Entry, key: str = "") -> str:
    """`entry` as a text from which `from_json` makes an equal one, but for recordings.

    `key` tells what the grade depends on, so that it is not made again while that is the same.
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


def from_json(text: str) -> tuple[Entry, str]:
    """The entry and the key that `to_json` wrote. Raises ValueError, KeyError or TypeError where it did not."""
    entries = json.loads(text)
    submitted = entries["submitted"]
    entry = Entry(
        student=Student(**entries["student"]),
        file=entries["file"],
        grade=_grade(entries["grade"]),
        submitted=datetime.fromisoformat(submitted) if submitted else None,
        adjustments=tuple(Adjustment(**adjustment) for adjustment in entries["adjustments"]),
        submitted_from=entries["submitted_from"],
    )
    return entry, str(entries["key"])


def _grade(entries: dict[str, Any]) -> Grade:
    return Grade(**{**entries, "verdicts": tuple(_verdict(verdict) for verdict in entries["verdicts"])})


def _verdict(entries: dict[str, Any]) -> Verdict:
    kept = {name: value for name, value in entries.items() if name != "earned"}
    finding = Finding(**entries["finding"]) if entries["finding"] else None
    return Verdict(**{**kept, "finding": finding, "blocked_by": tuple(entries["blocked_by"])})
