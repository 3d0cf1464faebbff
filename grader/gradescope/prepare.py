"""Prepares Gradescope's container: `python -m grader.gradescope.prepare EXERCISE_FOLDER [ISOLATION]`."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from grader.exercise.exercise import ExerciseError
from grader.exercise.loading import load
from grader.grading.grade import Options
from grader.grading.grading import grading_of
from grader.sandbox.isolation import Isolation
from grader.sandbox.program import SandboxUnavailable
from grader.workers.pool import HostFault, WorkerPool


def keep_beside(exercise: Path) -> None:
    """Let this process keep it beside the course that the exercise's folder is in, unless `SPINBOOK_CACHE` is set."""
    os.environ.setdefault("SPINBOOK_CACHE", str(exercise.resolve().parents[1] / "cache"))


def main(folder: Path, isolation: str = "") -> None:
    """Spin the solution and prove the exercise by it. A fault of the exercise's ends the build, with status 1.

    No sandbox ends nothing: a build may allow less than a run. Each submission then tells it, without a score.
    """
    keep_beside(folder)
    try:
        exercise = load(folder)
        with WorkerPool() as workers:
            grading = grading_of(exercise, Options(Isolation(isolation) if isolation else None), workers)
        print(f"Ready to grade {exercise.name}, isolation: {grading.runner.isolation}.")
    except (SandboxUnavailable, HostFault) as error:
        print(f"The solution could not be tried while the container was built:\n{error}")
    except ExerciseError as error:
        sys.exit(f"The exercise is at fault.\n{error}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:3])
