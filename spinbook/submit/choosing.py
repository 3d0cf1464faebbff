"""Finds the exercise and the file that a student means on the command line."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import NoExercise, find, load
from grader.submission.reading import NoSubmission, read
from spinbook.problem import Problem, SpinbookError
from spinbook.submit.hand_in import Candidate, candidates


def exercise_named(name: str) -> Exercise:
    """Return the exercise `name` of the course in this folder. Raises `UsageError` and `SpinbookError`."""
    try:
        return load(find(name, Path.cwd()))
    except NoExercise as error:
        raise click.UsageError(str(error)) from None
    except ExerciseError as error:
        raise SpinbookError(error.problem) from None


def given(file: Path, exercise: Exercise) -> Candidate:
    """Return the code in the file that the student named. Raises `UsageError` and `SpinbookError`."""
    if file.suffix not in (".py", ".ipynb"):
        raise click.UsageError(f"{file}: give a notebook (.ipynb) or a Python file (.py).")
    try:
        submission = read(str(file), exercise)
    except NoSubmission as error:
        raise click.UsageError(str(error)) from None
    if submission.program is None:
        raise SpinbookError(Problem(file, None, submission.problem, "There is no code for the exercise in it yet."))
    return Candidate(file, submission, file.name)


def found(exercise: Exercise, folder: Path, command: str, question: str) -> Candidate:
    """Return the code in the one file of `folder` that holds the exercise; of several the student chooses one.

    `command` is what the student typed. Raises `UsageError` and `SpinbookError`.
    """
    there = candidates(exercise, folder)
    if not there:
        raise SpinbookError(
            Problem(
                folder,
                None,
                f"nothing here holds {exercise.name}: no {exercise.file_name}, and no notebook with its cell.",
                f"Go to the folder of your notebook, or name the file: {command} {exercise.name} FILE",
            )
        )
    if len(there) == 1:
        return there[0]
    listed = [candidate.origin for candidate in there]
    if not sys.stdin.isatty():
        raise click.UsageError(f"Which file? {', '.join(listed)}. Name it: {command} {exercise.name} FILE")
    click.echo("More than one file here holds this exercise:")
    for number, name in enumerate(listed, start=1):
        click.echo(f"  {number}  {name}")
    return there[click.prompt(question, type=click.IntRange(1, len(there))) - 1]
