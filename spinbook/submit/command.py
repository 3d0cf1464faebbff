"""`spinbook check` and `spinbook submit`: the public checks in a terminal, and one file to upload."""

from __future__ import annotations

import contextlib
import sys
from dataclasses import replace
from pathlib import Path

import click
from rich.console import Console

from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade
from grader.grading.grading import grade_submission
from grader.report import hint_steps
from grader.report.checks import first_hints
from grader.report.terminal import show
from grader.sandbox.program import SandboxUnavailable
from grader.submission.submission import Submission
from grader.workers.pool import HostFault
from groundwork.files import from_here
from groundwork.problem import Problem
from spinbook.problem import SpinbookError
from spinbook.submit import hand_in as names
from spinbook.submit.hand_in import (
    HandIn,
    HandInCandidate,
    SelfCheck,
    candidate_in,
    choose_candidate,
    exercise_named,
    is_starter,
    self_check,
    write_upload,
)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option(
    "--student", help="Your name or number, as your course requires it; kept in this folder for the next time."
)
@click.option("--output", type=click.Path(path_type=Path), help="Where to write.  [default: EXERCISE-submission.zip]")
@click.option("--code", type=click.Path(path_type=Path), hidden=True, help="The code, as a kernel ran it last.")
@click.option("--no-check", is_flag=True, help="Write the file without running the checks first.")
def submit(
    exercise: str, file: Path | None, student: str | None, output: Path | None, code: Path | None, no_check: bool
) -> None:
    """Write ONE file to upload: your code for EXERCISE, and what the public checks say of it.

    \b
      spinbook submit joint_velocity                    finds your notebook or joint_velocity.py in this folder
      spinbook submit joint_velocity week3.ipynb        takes the exercise's cell in this notebook
      spinbook submit joint_velocity --student "Ada L"  puts your name into the file

    Save your notebook first. In the notebook itself, %submit joint_velocity does the same.

    The file, such as joint_velocity-submission.zip, is what you upload to your course's platform. Do not unpack or
    change it. You may hand in whatever the checks say: they are there to help you, and their result decides nothing.
    The grade comes from grading.

    Exit codes: 0 the file is written, 1 it could not be written, 2 wrong usage.
    """
    folder = Path.cwd()
    loaded = exercise_named(exercise)
    if code:
        # What a notebook's kernel ran last: it may not be saved yet.
        chosen = replace(candidate_in(code, loaded), file=file, origin="the cell as you ran it last")
    else:
        chosen = _chosen(loaded, file, "spinbook submit", "Which one do you hand in?")
    name = _student(student, folder)
    checked = SelfCheck(None, "It was left out.") if no_check else self_check(loaded, chosen.submission)
    console = Console(soft_wrap=False, highlight=False)
    print_result(checked, loaded, console)
    target = output or folder / f"{loaded.name}-submission.zip"
    try:
        write_upload(HandIn(loaded, chosen, name, checked), target)
    except OSError as error:
        problem = f"it can't be written: {error.strerror}."
        raise SpinbookError(Problem(target, None, problem, "Name another place: --output FILE")) from None
    console.print(f"Your code is from {chosen.origin}.", markup=False)
    for note in () if checked.grade else chosen.submission.notes:
        console.print(note, style="bold yellow", markup=False, soft_wrap=True)
    if is_starter(chosen, loaded):
        console.print("It is still the starter, as it was handed out. Was your work saved?", style="bold yellow")
    if not name:
        console.print("Your name is not in the file. If your course requires it: --student NAME", markup=False)
    console.print(f"Upload this file: {from_here(target)}", style="bold", markup=False, soft_wrap=True)


def print_result(checked: SelfCheck, exercise: Exercise, console: Console) -> None:
    """Print the result of the self-check, or why there is none."""
    if checked.grade:
        show(checked.grade, exercise, console, steps=1)
    else:
        console.print(f"No self-check: {checked.why} You can still hand in.", markup=False, soft_wrap=True)


def _chosen(exercise: Exercise, file: Path | None, command: str, question: str) -> HandInCandidate:
    """Return the code in the file that the student named, otherwise in the one of this folder that has it."""
    return candidate_in(file, exercise) if file else choose_candidate(exercise, Path.cwd(), command, question)


def _student(given: str | None, folder: Path) -> str:
    if given is not None:
        return names.remember_student(given, folder)
    known = names.remembered_student(folder)
    if known is None and sys.stdin.isatty():
        asked = click.prompt("Your name or number (leave empty to hand in without)", default="", show_default=False)
        return names.remember_student(asked, folder)
    return known or ""


#: Exit codes, in addition to click's 2 for wrong usage.
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
    loaded = exercise_named(exercise)
    chosen = _chosen(loaded, file, "spinbook check", "Which one do you want to check?")
    click.echo(f"Checking {chosen.origin}.")
    grade = _grade(loaded, chosen.submission)
    console = Console(soft_wrap=False, highlight=False)
    show(grade, loaded, console, verbose, steps=1)
    with contextlib.suppress(OSError):  # a folder that can't be written: then there are no further hints
        hint_steps.remember(loaded, hint_steps.last_hints(grade), Path.cwd())
        if first_hints(grade)[1]:
            console.print(f"More help: spinbook hint {exercise}", markup=False)
    sys.exit(HOST_FAULT if grade.outcome == "host-error" else ALL_PASS if grade.full_marks else SOME_FAIL)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
def hint(exercise: str) -> None:
    """Show the next hint about the first check that failed: where to look, and the next time what to do.

    It is about the last `spinbook check` (or %check) in this folder. How many hints you took is in
    .spinbook/hints.json; your instructor sees it only if the exercise says that hints are counted.
    """
    click.echo(hint_steps.next_hint(exercise_named(exercise), Path.cwd()))


def _grade(exercise: Exercise, submission: Submission) -> Grade:
    try:
        return grade_submission(exercise.public(), submission)
    except (HostFault, SandboxUnavailable) as error:
        click.echo(f"The machine or the grader is at fault, not your code: {error}", err=True)
        sys.exit(HOST_FAULT)
