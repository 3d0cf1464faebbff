"""Makes the container ready, when it is built: `python -m grader.gradescope.prepare EXERCISE_FOLDER [ISOLATION]`."""

from __future__ import annotations

import sys
from pathlib import Path

from grader.crew import Crew, HostFault
from grader.exercise import ExerciseError, load
from grader.gradescope.kept import keep_beside
from grader.grading import Options, grading_of
from grader.sandbox import Isolation, SandboxUnavailable


def main(folder: Path, isolation: str = "") -> None:
    """Spin the solution and prove the exercise by it. A fault of the exercise's ends the build, with status 1.

    No sandbox ends nothing: a build may allow less than a run. Each submission then tells it, without a score.
    """
    keep_beside(folder)
    try:
        exercise = load(folder)
        with Crew() as crew:
            grading = grading_of(exercise, Options(Isolation(isolation) if isolation else None), crew)
        print(f"Ready to grade {exercise.name}, isolation: {grading.spinner.isolation}.")
    except (SandboxUnavailable, HostFault) as error:
        print(f"The solution could not be tried while the container was built:\n{error}")
    except ExerciseError as error:
        sys.exit(f"The exercise is at fault.\n{error}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:3])
