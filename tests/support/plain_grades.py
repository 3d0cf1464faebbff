"""Grades and entries as plain data, for tests of what is made from them."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime, timedelta, timezone
from pathlib import Path

from grader.checking.verdict import Finding, Verdict
from grader.exercise import Exercise, load
from grader.grading import Grade
from grader.grading.grade import Entry, Student

ROOT = Path(__file__).parents[2]

WHEN = datetime(2026, 11, 20, 23, 41, 7, tzinfo=timezone(timedelta(hours=1)))

PUBLIC = Verdict("test_answers", "It answers each message.", "passed", 6.0, hint="Call publish().")
HIDDEN = Verdict("test_secret_gap", "It survives a long gap.", "passed", 4.0, hint="Think of stamps.", hidden=True)

SECRET = Finding(
    "Message 4 of 9 (31.40 s after the start; nothing comes for 30 s): expected 2.5, got 7.", "gap", 4, 31.4
)


def exercise() -> Exercise:
    """The exercise joint_velocity."""
    return load(ROOT / "exercises" / "joint_velocity")


def failed(verdict: Verdict, finding: Finding = SECRET) -> Verdict:
    """Return the same check, not passed."""
    return replace(verdict, status="failed", finding=finding)


def grade(*verdicts: Verdict, **fields: object) -> Grade:
    """Return a grade of 10 points with these verdicts."""
    made = Grade(
        exercise="joint_velocity",
        submission="node.py",
        digest="0" * 64,
        outcome="graded",
        message="",
        score=sum(verdict.earned for verdict in verdicts),
        points=10.0,
        verdicts=verdicts,
        isolation="bubblewrap",
        seed=1,
        versions={"python": "3.11"},
        seconds=2.5,
    )
    return replace(made, **fields)  # type: ignore[arg-type]


def entry(of: Grade, student: Student | None = None, **fields: object) -> Entry:
    """Return a student's entry."""
    made = Entry(student or Student("ada", "Ada Lovelace", "ada@example.org"), "ada/node.py", of, WHEN)
    return replace(made, **fields)  # type: ignore[arg-type]


RIGHT = grade(PUBLIC, HIDDEN)
HALF = grade(PUBLIC, failed(HIDDEN))
FAULT = grade(outcome="host-error", message="This is not your fault: the disk is full")
CRASHED = grade(
    replace(PUBLIC, status="failed"), replace(HIDDEN, status="failed"), outcome="crashed", message="It ended by itself."
)
