"""The command `spinbook grade`, also `python -m grader`."""

from __future__ import annotations

import sys
from pathlib import Path

import click
from rich.console import Console

from grader.crew import Crew, HostFault
from grader.exercise import Exercise, ExerciseError, load
from grader.grading import Grade, Options, grading_of
from grader.report.as_json import as_json
from grader.report.terminal import show
from grader.sandbox import Isolation, SandboxUnavailable
from grader.submission import NoSubmission, Submission, read

#: Exit codes. 2 is click's own, for usage.
FULL_MARKS, NOT_FULL_MARKS, USAGE, OUR_FAULT = 0, 1, 2, 3


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.argument("submission")
@click.option("--json", "json_", is_flag=True, help="Print the grade as JSON, for programs.")
@click.option("--plot", type=click.Path(path_type=Path), help="Draw your node's output over the solution's (.svg).")
@click.option(
    "--bag", type=click.Path(path_type=Path), help="Write every scenario as a rosbag2 (MCAP) into this folder."
)
@click.option("-v", "--verbose", is_flag=True, help="Print the node's log, too.")
@click.option("--real-time", is_flag=True, help="Spin at the pace of real time, not as fast as it goes.")
@click.option("--seed", default=1, show_default=True, help="Chooses the numbers of scenarios that have chance in them.")
@click.option(
    "--isolation",
    type=click.Choice([level.value for level in Isolation]),
    help="How the node is kept apart from this machine.  [default: the strongest that works here]",
)
def grade(
    exercise: str,
    submission: str,
    json_: bool,
    plot: Path | None,
    bag: Path | None,
    verbose: bool,
    real_time: bool,
    seed: int,
    isolation: str | None,
) -> None:
    """Grade one SUBMISSION for an EXERCISE: spin the node, and say what is right and wrong.

    The node is started as its own process, in a sandbox, and not changed. Reference publishers send it messages
    under a simulated clock; what it publishes is compared with what the solution publishes.

    \b
      spinbook grade joint_velocity joint_velocity.py         a file
      spinbook grade joint_velocity week3.ipynb               the exercise's cell in a notebook
      spinbook grade joint_velocity my_package/joint_velocity an installed package's executable
      spinbook grade joint_velocity mine.py --plot mine.svg   see where it first goes wrong
      spinbook grade joint_velocity mine.py --verbose         see what the node logged

    EXERCISE is a name in the course's folder exercises/, or the path of an exercise's folder. A check that can't be
    judged because another failed is marked as blocked.

    Exit codes: 0 full marks, 1 not, 2 wrong usage, 3 a fault of the course's or the machine's.
    """
    try:
        found = load(_folder(exercise))
        handed_in = read(submission, found)
        options = Options(Isolation(isolation) if isolation else None, seed, 1.0 if real_time else None)
        result = _graded(found, handed_in, options)
    except NoSubmission as error:
        raise click.UsageError(str(error)) from None
    except ExerciseError as error:
        _stop(f"The exercise is at fault, not the submission.\n{error}")
    except SandboxUnavailable as error:
        _stop(str(error))
    except HostFault as error:
        _stop(f"The machine or the grader is at fault, not the submission: {error}")
    if json_:
        click.echo(as_json(result), nl=False)
    else:
        show(result, found, Console(soft_wrap=False, highlight=False), verbose)
    _write(result, found, plot, bag)
    sys.exit(OUR_FAULT if result.outcome == "host-error" else NOT_FULL_MARKS if not result.full_marks else FULL_MARKS)


def _graded(exercise: Exercise, submission: Submission, options: Options) -> Grade:
    with Crew() as crew:
        return grading_of(exercise, options, crew).grade(submission)


def _write(result: Grade, exercise: Exercise, plot: Path | None, bag: Path | None) -> None:
    try:
        if plot:
            from grader.report.plot import draw

            draw(result, exercise, plot)
        if bag:
            from grader.report.bag import NoBagWriter, write_bags

            try:
                write_bags(result, bag)
            except NoBagWriter as error:
                _stop(str(error))
    except OSError as error:
        _stop(f"{error.filename}: {error.strerror}")
    except ValueError as error:
        _stop(str(error))


def _folder(exercise: str) -> Path:
    """The folder that EXERCISE means: a path, or a name in the exercises/ of this folder or of one above it."""
    if Path(exercise, "exercise.toml").exists():
        return Path(exercise)
    known: list[str] = []
    for course in (Path.cwd(), *Path.cwd().parents):
        exercises = course / "exercises"
        if (exercises / exercise / "exercise.toml").exists():
            return exercises / exercise
        known += sorted(file.parent.name for file in exercises.glob("*/exercise.toml"))
    told = f"There are: {', '.join(known)}." if known else "Start in a course's folder, the one with exercises/ in it."
    raise click.UsageError(f"There is no exercise {exercise!r} here. {told}")


def _stop(message: str) -> None:
    click.echo(message, err=True)
    sys.exit(OUR_FAULT)
