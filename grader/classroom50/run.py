"""Grades a repository: `python -m grader.classroom50.run EXERCISE_FOLDER REPOSITORY [ISOLATION]`.

Writes result.json and release-body.md into REPOSITORY, as Classroom 50's runner expects, and the same text into the
summary of a job of GitHub Actions. Exits with 1, without either, where the machine or the exercise is at fault.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from grader.classroom50.result import result, summary
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import load
from grader.files import write_if_changed
from grader.gradescope.prepare import keep_beside
from grader.gradescope.run import submission
from grader.grading.grade import Grade, Options
from grader.grading.grading import grading_of
from grader.sandbox.isolation import Isolation
from grader.sandbox.program import SandboxUnavailable
from grader.workers.pool import HostFault, WorkerPool


def main(folder: Path, repository: Path, isolation: str = "") -> int:
    """Grade what is in `repository`; return the exit code."""
    keep_beside(folder)
    try:
        exercise = load(folder)
        grade = _grade(exercise, repository, isolation)
    except (ExerciseError, SandboxUnavailable, HostFault) as error:
        return _fault(str(error))
    if grade.outcome == "host-error":
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


def _grade(exercise: Exercise, repository: Path, isolation: str) -> Grade:
    with WorkerPool() as workers:
        options = Options(Isolation(isolation) if isolation else None)
        return grading_of(exercise, options, workers).grade(submission(repository, exercise))


def _fault(text: str) -> int:
    print(f"Not graded, and that is not the student's fault: {text}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]), *sys.argv[3:4]))
