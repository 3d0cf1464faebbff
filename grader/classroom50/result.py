"""A grade as Classroom 50's result.json, and as the text of a release and of a job's summary.

The form is `classroom50/result/v1`: https://github.com/foundation50/classroom50/wiki/Advanced-Autograding, "The
result.json contract".
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime, timezone
from typing import Any

from grader.grading.grade import Grade
from grader.report.feedback import ShownCheck, shown_checks
from grader.report.printable import printable

SCHEMA = "classroom50/result/v1"

#: Scores are whole numbers there. Where an exercise gives parts of points, every number is a hundred times as large.
HUNDREDTHS = 100

LONGEST_TEXT = 5_000


def result(grade: Grade, environment: Mapping[str, str]) -> dict[str, Any]:
    """Return what result.json holds. Of hidden checks it tells title and hint alone, as the feedback page does.

    `environment` is what the runner sets; in any other job of GitHub Actions what is missing is made from `GITHUB_*`.
    """
    scale = (
        1 if all(float(v.points).is_integer() and float(v.earned).is_integer() for v in grade.verdicts) else HUNDREDTHS
    )
    tests = [_test(check, scale) for check in shown_checks(grade)]
    return {
        "schema": SCHEMA,
        **_identity(grade, environment),
        "datetime": datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "score": sum(test["score"] for test in tests),
        "max-score": sum(test["max-score"] for test in tests),
        "tests": tests,
    }


def _identity(grade: Grade, environment: Mapping[str, str]) -> dict[str, str]:
    server = environment.get("GITHUB_SERVER_URL", "https://github.com").rstrip("/")
    repository = f"{server}/{environment.get('GITHUB_REPOSITORY', '')}"
    commit = environment.get("COMMIT_URL") or f"{repository}/commit/{environment.get('GITHUB_SHA', '')}"
    return {
        "classroom": environment.get("CLASSROOM", ""),
        "assignment": environment.get("ASSIGNMENT") or grade.exercise,
        "submission": environment.get("SUBMISSION_TAG") or environment.get("GITHUB_SHA", ""),
        "commit": commit,
        "release": environment.get("RELEASE_URL") or commit,
        "review": environment.get("REVIEW_URL") or commit,
    }


def _test(check: ShownCheck, scale: int) -> dict[str, Any]:
    return {
        "test-name": printable(check.title, LONGEST_TEXT),
        "passed": check.status == "passed",
        "score": round(check.earned * scale),
        "max-score": round(check.points * scale),
        "output": printable(check.text, LONGEST_TEXT),
    }


def summary(grade: Grade, title: str) -> str:
    """Return the grade as Markdown, for release-body.md and the job's summary."""
    lines = [f"## {title}: {grade.score:g} of {grade.points:g} points", ""]
    if grade.message:
        lines += [_fenced(grade.message), ""]
    lines += ["| | points | check |", "| --- | --- | --- |"]
    checks = shown_checks(grade)
    lines += [f"| {check.sign} | {check.earned:g}/{check.points:g} | {_cell(check.title)} |" for check in checks]
    for check in checks:
        if check.status == "failed" and check.text:
            lines += ["", f"**{_cell(check.title)}**", "", _fenced(check.text)]
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return printable(text.replace("|", "\\|").replace("\n", " "), LONGEST_TEXT)


def _fenced(text: str) -> str:
    """Return a text that a student can choose parts of as a block in which nothing is markup."""
    shown = printable(text, LONGEST_TEXT)
    fence = "`" * 3
    while fence in shown:
        fence += "`"
    return f"{fence}text\n{shown}\n{fence}"
