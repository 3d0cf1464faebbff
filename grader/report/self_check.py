"""What a self-check says below its verdicts, in words."""

from __future__ import annotations

from grader.grading import Grade
from grader.sandbox import Isolation, Middleware


def total(grade: Grade) -> str:
    """How much of what could be judged here is right: "8 of 8 public checks, 50 of 50 points"."""
    passed = sum(verdict.status == "passed" for verdict in grade.verdicts)
    return f"{passed} of {len(grade.verdicts)} public checks, {grade.score:g} of {grade.points:g} points"


def to_come(grade: Grade) -> str:
    """What is judged later; empty where all checks are public."""
    count = grade.hidden_checks
    if not count:
        return ""
    return f"{count} hidden check{'s' * (count > 1)} ({grade.hidden_points:g} points) will be judged after you hand in."


def standing(grade: Grade) -> str:
    """That this is no grade, and how the code ran."""
    told = "This is a self-check, not your grade."
    if grade.isolation == Isolation.NONE.value:
        told += " Your code ran without a sandbox, and no grade of record is made that way."
    if grade.versions["middleware"] == Middleware.FASTDDS.value:
        told += " It ran over Fast DDS: a node with threads or sleeps of its own may get another result each time."
    return told


def lines(grade: Grade) -> list[str]:
    """All of it, a line each."""
    return [line for line in (f"{total(grade)}.", to_come(grade), standing(grade)) if line]
