"""Grades one submission in Gradescope's container: `python -m grader.gradescope.run EXERCISE_FOLDER ROOT [ISOLATION]`.

On Gradescope, ROOT is `/autograder`. It contains `submission/` and `submission_metadata.json`, and
`results/results.json` is written there. Gradescope shows the output of this program only to instructors.

`python -m grader.gradescope.run prepare EXERCISE_FOLDER [ISOLATION]` prepares the container while it is built.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import traceback
from datetime import datetime
from pathlib import Path
from typing import Any

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import load
from grader.grading.grade import Entry, Options, Student
from grader.grading.grading import grade_submission, grading_of
from grader.report.as_json import gradescope_results, no_score
from grader.sandbox.program import Isolation, SandboxUnavailable
from grader.submission.reader import read
from grader.submission.submission import Submission
from grader.workers.pool import HostFault, WorkerPool
from groundwork.files import write_if_changed
from groundwork.plain_text import print_in_any_encoding


def cache_next_to_course(exercise: Path) -> None:
    """Use a cache next to the course that contains the exercise's folder, unless `SPINBOOK_CACHE` is set."""
    os.environ.setdefault("SPINBOOK_CACHE", str(exercise.resolve().parents[1] / "cache"))


def options_of(isolation: str) -> Options:
    """Return how to grade at this level of isolation; without one, at the strongest that works."""
    return Options(Isolation(isolation) if isolation else None)


def prepare(folder: Path, isolation: str = "") -> None:
    """Run the solution, and test the exercise with it. A fault of the exercise ends the build, with status 1.

    A missing sandbox does not end the build, which may be allowed less than a run. If it is missing for a submission
    too, the result says so, without a score.
    """
    cache_next_to_course(folder)
    try:
        exercise = load(folder)
        with WorkerPool() as workers:
            grading = grading_of(exercise, options_of(isolation), workers)
        print(f"Ready to grade {exercise.name}, isolation: {grading.runner.isolation}.")
    except (SandboxUnavailable, HostFault) as error:
        print(f"The solution could not be tried while the container was built:\n{error}")
    except ExerciseError as error:
        sys.exit(f"The exercise is at fault.\n{error}")


def main(folder: Path, root: Path, isolation: str = "") -> None:
    """Grade what is in `root/submission`. A fault of ours is reported, without a score."""
    cache_next_to_course(folder)
    try:
        text = gradescope_results(_entry(load(folder), root, isolation))
    except (ExerciseError, SandboxUnavailable, HostFault) as error:
        print(error)
        text = no_score("The autograder is not set up right; its output says more.")
    except Exception:
        traceback.print_exc(file=sys.stdout)
        text = no_score("The autograder broke; its output says more.")
    write_if_changed(
        root / "results" / "results.json", json.dumps(text, indent=2, ensure_ascii=False) + "\n", durable=True
    )


def _entry(exercise: Exercise, root: Path, isolation: str) -> Entry:
    handed_in = submission(root / "submission", exercise)
    grade = grade_submission(exercise, handed_in, options_of(isolation))
    if not grade.has_score:
        print(grade.message)
    student, submitted = _metadata(root / "submission_metadata.json")
    return Entry(student, Path(handed_in.name).name, grade, submitted, submitted_from="Gradescope")


def submission(folder: Path, exercise: Exercise) -> Submission:
    """Return what a student has uploaded: the only file, or the program among several files."""
    files = [file for file in folder.rglob("*") if file.is_file() and not file.is_symlink()]
    return read(str(files[0] if len(files) == 1 else folder), exercise)


def _metadata(file: Path) -> tuple[Student, datetime | None]:
    """Return the student, and the time of the submission, as far as Gradescope says."""
    student, submitted = Student("student"), None
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError, IndexError, AttributeError):
        text: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        user = text["users"][0]
        student = Student(str(user["id"]), str(user.get("name", "")), str(user.get("email", "")))
        submitted = datetime.fromisoformat(text["created_at"])
    return student, submitted


if __name__ == "__main__":
    print_in_any_encoding()
    if sys.argv[1] == "prepare":
        prepare(Path(sys.argv[2]), *sys.argv[3:4])
    else:
        main(Path(sys.argv[1]), Path(sys.argv[2]), *sys.argv[3:4])
