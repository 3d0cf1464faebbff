"""Compares the grades in a class's results with what each must be."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from students import Expected, Handed

from grader.classroom.names import student_id


def wrong_with(handed: Handed, results: Path) -> str:
    """Why a student's grade is not what it must be, or nothing."""
    file = results / "students" / student_id(handed.student) / "grade.json"
    try:
        entry = json.loads(file.read_text(encoding="utf-8"))
    except OSError:
        return "there is no grade"
    return _wrong(entry, handed.expected)


def _wrong(entry: dict[str, Any], expected: Expected) -> str:
    grade = entry["grade"]
    if grade["outcome"] not in expected.outcomes:
        return f"{grade['outcome']}, not {' or '.join(expected.outcomes)}: {grade['message']}"
    return _wrong_points(entry, expected) or _wrong_checks(grade, expected) or _wrong_words(grade, expected)


def _wrong_points(entry: dict[str, Any], expected: Expected) -> str:
    grade = entry["grade"]
    earned = round(sum(map(_earned, grade["verdicts"])), 2)
    if not entry["final"] == grade["score"] == earned:
        return f"final {entry['final']}, score {grade['score']}, but the checks give {earned}"
    full = grade["score"] == grade["points"]
    right = {"zero": grade["score"] == 0, "full": full, "less": not full, "any": True}
    if right[expected.score]:
        return ""
    score = f"{grade['score']:g} of {grade['points']:g} points, not {expected.score}"
    return f"{score}; it fails {sorted(_failed(grade))}"


def _earned(verdict: dict[str, Any]) -> float:
    """The points of one check: all if it passes, and a part only if the check gives parts."""
    if verdict["status"] == "passed":
        return float(verdict["points"])
    partial = verdict["status"] == "failed" and verdict.get("partial")
    return float(verdict["earned"]) if partial else 0.0


def _failed(grade: dict[str, Any]) -> set[str]:
    return {verdict["name"] for verdict in grade["verdicts"] if verdict["status"] == "failed"}


def _wrong_checks(grade: dict[str, Any], expected: Expected) -> str:
    if expected.fails is None:
        return ""
    failed = _failed(grade)
    if failed != expected.fails:
        return f"it fails {sorted(failed)}, not {sorted(expected.fails)}"
    blocked = {v["name"]: set(v["blocked_by"]) for v in grade["verdicts"] if v["status"] == "blocked"}
    loose = [name for name, by in blocked.items() if not by & (failed | set(blocked))]
    return f"blocked by nothing that fails: {loose}" if loose else ""


def _wrong_words(grade: dict[str, Any], expected: Expected) -> str:
    message = _message(grade)
    if missing := [words for words in expected.words if not re.search(words, message, re.IGNORECASE)]:
        return f"the feedback lacks {missing}: {message[:200]}"
    if leaked := [word for word in expected.never if word in grade["log"]]:
        return f"an attack has worked: {leaked}"
    return ""


def _message(grade: dict[str, Any]) -> str:
    findings = [verdict["finding"]["text"] for verdict in grade["verdicts"] if verdict["finding"]]
    titles = [verdict["title"] for verdict in grade["verdicts"] if verdict["status"] == "failed"]
    return "\n".join([grade["message"], *findings, *titles])
