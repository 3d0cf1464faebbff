"""The command `spinbook replay`: plots and bags of what a student's program did, for questions about its grade."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import click

from grader.classroom.results import NotWritable, Results
from grader.exercise.exercise import ExerciseError
from grader.exercise.loading import NoExercise, find, load
from grader.grading.grade import Grade
from grader.report.as_json import folder_of
from grader.report.bag import NoBagWriter, write_bags
from grader.report.plot import draw

#: Exit codes, besides click's 2 for usage.
DONE, FAULT = 0, 3


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("results", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("student")
@click.option("--exercise", default="", help="The exercise's name or folder.  [default: the one that was graded]")
@click.option("--out", type=click.Path(path_type=Path), help="The folder to write to.  [default: ./STUDENT-replay]")
def replay(results: Path, student: str, exercise: str, out: Path | None) -> None:
    """Draw and write what a STUDENT's program did when it was graded, from the recordings in RESULTS.

    Nothing is run: the recordings are those that were graded, even if the exercise has changed
    since. Each scenario becomes a plot over the solution's, and a rosbag2 (MCAP) for Foxglove, PlotJuggler or
    `ros2 bag play`. STUDENT is the name of a folder in RESULTS/students.

    \b
      spinbook replay results/joint_velocity anna
    """
    grade = _recorded(results, student)
    folder = out or Path(f"{student}-replay")
    try:
        loaded = load(find(exercise or grade.exercise, Path.cwd()))
        plots = [draw(grade, loaded, folder / "plots" / f"{name}.svg", name) for name in grade.recordings]
        written = sum(plots) + len(write_bags(grade, folder / "bags"))
    except NoExercise as error:
        raise click.UsageError(f"{error} Give it with --exercise.") from None
    except ExerciseError as error:
        _stop(f"The exercise is at fault.\n{error}")
    except NoBagWriter as error:
        _stop(str(error))
    except OSError as error:
        _stop(str(NotWritable(folder, error)))
    click.echo(f"{student}: {grade.score:g} of {grade.points:g} points, {len(grade.recordings)} scenarios.")
    click.echo(f"{written} files in {folder}: plots/SCENARIO.svg, bags/SCENARIO/.")


def _recorded(results: Path, student: str) -> Grade:
    """Return the stored grade with its recordings and the solution's."""
    stores = Results(results)
    entry, stored = stores.entry(student), stores.stored(student)
    if entry is None:
        names = sorted(folder.name for folder in folder_of(results, "").glob("*/"))
        known = ", ".join(names[:10]) + (" …" if len(names) > 10 else "")
        raise click.UsageError(f"{results}: there is no grade of a student called {student!r} (there are: {known}).")
    if entry[0].grade.outcome in ("undecided", "missing"):
        raise click.UsageError(f"{results}: nothing of {student} was run. {entry[0].grade.message}")
    if stored is None or not stored.recordings:
        raise click.UsageError(
            f"{results}: there is no recording of {student}. A class that was graded on a cluster has none; grade the "
            f"submission here, which gives the same: spinbook grade {entry[0].grade.exercise} … --regrade {student}"
        )
    if stored.recordings.keys() - stored.references.keys():
        raise click.UsageError(f"{results}: the solution's recordings are missing or damaged: grade {student} again.")
    return replace(entry[0].grade, recordings=stored.recordings, references=stored.references)


def _stop(message: str) -> NoReturn:
    click.echo(message, err=True)
    sys.exit(FAULT)
