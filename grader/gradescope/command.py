"""The command `spinbook gradescope`."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from grader.exercise import ExerciseError, load
from grader.exercise.finding import NoExercise, find
from grader.gradescope.bundle import NoSource, bundle
from grader.sandbox import Isolation


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.option("--out", type=click.Path(path_type=Path), help="The zip to write.  [default: EXERCISE-gradescope.zip]")
@click.option(
    "--isolation",
    type=click.Choice([level.value for level in Isolation]),
    help="How students' nodes are kept apart in the container.  [default: the strongest that works there]",
)
def gradescope(exercise: str, out: Path | None, isolation: str | None) -> None:
    """Write the autograder that Gradescope runs for an EXERCISE, as one zip to upload.

    It holds setup.sh, which installs the grader and ROS 2 when Gradescope builds its container (Ubuntu 22.04 or newer),
    run_autograder, which grades each submission there, the exercise and its solution. Public checks are visible to
    students at once, hidden ones when you publish the grades.

    Exit codes: 0 written, 2 wrong usage, 3 the exercise is at fault.
    """
    try:
        content = bundle(load(find(exercise, Path.cwd())), Isolation(isolation) if isolation else None)
    except (NoExercise, NoSource) as error:
        raise click.UsageError(str(error)) from None
    except ExerciseError as error:
        click.echo(str(error), err=True)
        sys.exit(3)
    file = out or Path(f"{exercise.rstrip('/').split('/')[-1]}-gradescope.zip")
    try:
        file.write_bytes(content)
    except OSError as error:
        raise click.UsageError(f"{file}: {error.strerror}") from None
    click.echo(f"{file}: upload it to Gradescope, under Configure Autograder.")
