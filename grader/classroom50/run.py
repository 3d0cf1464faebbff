"""Grades a repository: `python -m grader.classroom50.run EXERCISE_FOLDER REPOSITORY [ISOLATION]`.

It writes result.json and release-body.md into REPOSITORY, as Classroom 50's runner expects, and the same text into the
summary of a job of GitHub Actions. It exits with 1, and writes neither, if the machine or the exercise is at fault.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from grader.exercise.exercise import ExerciseError
from grader.exercise.loading import load
from grader.gradescope.run import cache_next_to_course, options_of, submission
from grader.grading.grade import Grade
from grader.grading.grading import grade_submission
from grader.report.checks import ShownCheck, shown_checks
from grader.report.printable import printable
from grader.sandbox.program import SandboxUnavailable
from grader.workers.pool import HostFault
from groundwork.files import write_if_changed
from groundwork.plain_text import print_in_any_encoding


def main(folder: Path, repository: Path, isolation: str = "") -> int:
    """Grade what is in `repository`; return the exit code."""
    cache_next_to_course(folder)
    try:
        exercise = load(folder)
        grade = grade_submission(exercise, submission(repository, exercise), options_of(isolation))
    except (ExerciseError, SandboxUnavailable, HostFault) as error:
        return _fault(str(error))
    if not grade.has_score:
        return _fault(grade.message)
    text = summary(grade, exercise.title)
    write_if_changed(
        repository / "result.json",
        json.dumps(result(grade, os.environ), indent=2, ensure_ascii=False) + "\n",
        durable=True,
    )
    write_if_changed(repository / "release-body.md", text, durable=True)
    if page := os.environ.get("GITHUB_STEP_SUMMARY"):
        with Path(page).open("a", encoding="utf-8") as file:
            file.write(text)
    print(f"{grade.score:g} of {grade.points:g} points")
    return 0


def _fault(text: str) -> int:
    print(f"Not graded, and that is not the student's fault: {text}", file=sys.stderr)
    return 1


#: https://github.com/foundation50/classroom50/wiki/Advanced-Autograding, "The result.json contract".
SCHEMA = "classroom50/result/v1"

#: Classroom 50's scores are whole numbers: if an exercise gives fractions of points, all are multiplied by this.
HUNDREDTHS = 100

LONGEST_TEXT = 5_000


def result(grade: Grade, environment: Mapping[str, str]) -> dict[str, Any]:
    """Return the content of result.json.

    Of hidden checks it has only title and hint, like the feedback page. `environment` is what the runner sets; in other
    jobs of GitHub Actions, missing values are made from `GITHUB_*`.
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
    """Return a text that a student can influence, as a block without markup."""
    shown = printable(text, LONGEST_TEXT)
    fence = "`" * 3
    while fence in shown:
        fence += "`"
    return f"{fence}text\n{shown}\n{fence}"


if __name__ == "__main__":
    print_in_any_encoding()
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]), *sys.argv[3:4]))
