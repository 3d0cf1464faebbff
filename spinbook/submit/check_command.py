"""`spinbook check`: the public checks in a terminal, as `%check` runs them in a notebook."""

from __future__ import annotations

import sys
from pathlib import Path

import click
from rich.console import Console

from grader.exercise.exercise import Exercise, ExerciseError
from grader.grading.grade import Grade
from grader.grading.grading import grade_submission
from grader.report.terminal import show
from grader.sandbox.program import SandboxUnavailable
from grader.submission.reading import Submission
from grader.workers.pool import HostFault
from spinbook.problem import SpinbookError
from spinbook.submit.hand_in import exercise_named, found, given

#: Exit codes, besides click's 2 for usage.
ALL_PASS, SOME_FAIL, HOST_FAULT = 0, 1, 3


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option("-v", "--verbose", is_flag=True, help="Also print what your node printed.")
def check(exercise: str, file: Path | None, verbose: bool) -> None:
    """Run the public checks of EXERCISE on your node, as %check does in a notebook.

    \b
      spinbook check joint_velocity                    finds your notebook or joint_velocity.py in this folder
      spinbook check joint_velocity joint_velocity.py  checks this file
      spinbook check joint_velocity week3.ipynb        checks the exercise's cell in this notebook, as it was saved

    This is not your grade: hidden checks come after you hand in. `spinbook submit` makes the file that you hand in.

    Exit codes: 0 every public check passes, 1 not, 2 wrong usage, 3 the exercise or this machine is at fault.
    """
    wanted = exercise_named(exercise)
    command, question = "spinbook check", "Which one do you want to check?"
    chosen = given(file, wanted) if file else found(wanted, Path.cwd(), command, question)
    click.echo(f"Checking {chosen.origin}.")
    grade = _grade(wanted, chosen.submission)
    show(grade, wanted, Console(soft_wrap=False, highlight=False), verbose)
    sys.exit(HOST_FAULT if grade.outcome == "host-error" else ALL_PASS if grade.full_marks else SOME_FAIL)


def _grade(exercise: Exercise, submission: Submission) -> Grade:
    try:
        return grade_submission(exercise.public(), submission)
    except ExerciseError as error:
        raise SpinbookError(error.problem) from None
    except (HostFault, SandboxUnavailable) as error:
        click.echo(f"The machine or the grader is at fault, not your code: {error}", err=True)
        sys.exit(HOST_FAULT)
