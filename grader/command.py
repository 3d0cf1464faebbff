"""The command `spinbook grade`, also `python -m grader`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import find, load
from grader.sandbox.program import Isolation, SandboxUnavailable
from grader.submission.file_kinds import kind_of
from grader.submission.reader import is_one, of_mistake, read
from grader.submission.submission import Submission
from grader.workers.pool import HostFault, WorkerPool, leave_cpus_to_workers
from ros_in_python.svg_file import SvgFile

if TYPE_CHECKING:
    from grader.grading.grade import Grade

#: Exit codes. 2 is click's own, for usage.
FULL_MARKS, NOT_FULL_MARKS, USAGE, OUR_FAULT = 0, 1, 2, 3

_PATH = click.Path(path_type=Path)
_TABLE = click.Path(path_type=Path, exists=True, dir_okay=False)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.argument("submission", required=False, default="")
@click.option(
    "--mistake", metavar="NAME", default="", help="Grade a usual mistake from the exercise's solutions folder."
)
@click.option("--json", "json_", is_flag=True, help="Print the grade as JSON, for programs.")
@click.option("--plot", type=SvgFile(), help="Draw your node's output over the solution's (.svg).")
@click.option("--bag", type=_PATH, help="Write every scenario as a rosbag2 (MCAP) into this folder.")
@click.option("-v", "--verbose", is_flag=True, help="Print the node's log, too.")
@click.option("--real-time", is_flag=True, help="Run in real time, not as fast as possible.")
@click.option("--seed", default=1, show_default=True, help="The seed for scenarios with random values.")
@click.option(
    "--isolation",
    type=click.Choice([level.value for level in Isolation]),
    help="How to isolate the node from this machine.  [default: the strongest that works here]",
)
@click.option("--out", type=_PATH, help="A class: the folder for the results.")
# From here on, the names are those of the fields of ClassRequest.
@click.option("--jobs", type=click.IntRange(1, 64), help="A class: how many submissions to grade at once.")
@click.option(
    "--format", metavar="NAME", default="", help="A class: how to read it, such as canvas, if it is not clear."
)
@click.option(
    "--attempts", type=click.Choice(["last", "first", "best"]), help="A class: which of several attempts counts."
)
@click.option(
    "--roster",
    type=_TABLE,
    help="A class: everybody in it, as a CSV file with the column student, or a list that your platform exports.",
)
@click.option("--groups", type=_TABLE, help="A class: a CSV file with the columns group, student.")
@click.option("--skip", is_flag=True, help="A class: grade everything that is clear, and end with exit code 1.")
@click.option(
    "--regrade",
    multiple=True,
    is_flag=False,
    flag_value="*",
    metavar="[STUDENT]",
    help="A class: grade unchanged submissions again, of all students or of one, and show what is different.",
)
@click.option("--overrides", type=_TABLE, help="A class: a CSV file with the columns student, points or due, reason.")
@click.option("--scheduler", metavar="ADDRESS", default="", help="A class: grade on this Dask cluster.")
@click.option(
    "--rejudge",
    is_flag=True,
    help="A class: judge the stored recordings with the checks as they are now, without running anything, and show "
    "what is different before any grade is replaced.",
)
@click.option("--yes", "replace", is_flag=True, help="With --rejudge: replace the grades without asking.")
@click.option("--publish", is_flag=True, help="A class: also write one zip per student, to hand out.")
def grade(
    exercise: str,
    submission: str,
    mistake: str,
    json_: bool,
    plot: Path | None,
    bag: Path | None,
    verbose: bool,
    real_time: bool,
    seed: int,
    isolation: str | None,
    out: Path | None,
    **of_class: Any,
) -> None:
    """Grade one SUBMISSION for an EXERCISE, or a whole class: run the node, and say what is right and what is wrong.

    The grader starts the node unchanged, as its own process in a sandbox. Reference publishers send it messages under
    a simulated clock, and the grader compares what it publishes with what the solution publishes.

    \b
      spinbook grade joint_velocity joint_velocity.py         a file
      spinbook grade joint_velocity week3.ipynb               the exercise's cell in a notebook
      spinbook grade joint_velocity upload.zip                what `spinbook submit` has written
      spinbook grade joint_velocity my_workspace/             a ROS 2 package or workspace, as a folder or an archive
      spinbook grade joint_velocity my_package/joint_velocity an installed package's executable
      spinbook grade joint_velocity mine.py --plot mine.svg   see where it first goes wrong
      spinbook grade joint_velocity mine.py --verbose         see what the node logged
      spinbook grade joint_velocity --mistake fixed_dt        one of the author's usual mistakes

    EXERCISE is a name in the course's folder exercises/, or the path of an exercise's folder. A check that can't be
    judged because another failed is marked as blocked.

    Exit codes: 0 full marks, 1 less than full marks, 2 wrong usage, 3 a fault of the course or the machine.

    A class is a folder with one file (or one folder) per student, nbgrader's folder, the download of a learning
    platform such as Moodle or Canvas, or a CSV file with the columns file and student. If it is not clear whose a file
    is, which one counts or when it was handed in, the command says so and grades nothing. It does not grade unchanged
    submissions again, and continues a run that was stopped. Exit codes for a class: 0 all graded, 1 some need your
    decision, 2 wrong usage, 3 a fault of Spinbook or the machine, 130 stopped with Ctrl-C.

    \b
      spinbook grade joint_velocity submissions/ --out results/
      spinbook grade joint_velocity moodle.zip --out results/ --overrides extensions.csv
      spinbook grade joint_velocity submissions/ --out results/ --regrade anna
      spinbook grade joint_velocity submissions/ --out results/ --rejudge
    """
    if bool(submission) == bool(mistake):
        raise click.UsageError("Give a SUBMISSION, or --mistake NAME for one of the exercise's usual mistakes.")
    leave_cpus_to_workers()
    options: dict[str, Any] = {
        "isolation": Isolation(isolation) if isolation else None,
        "seed": seed,
        "pace": 1.0 if real_time else None,
    }
    try:
        loaded = load(find(exercise, Path.cwd()))
        if out and not mistake:
            _refuse_a_single_program(submission)
            _refuse_results_among_submissions(Path(submission), out)
            sys.exit(_class(loaded, Path(submission), out, options, of_class))
        is_class = submission.endswith(".csv") or (Path(submission).is_dir() and not is_one(Path(submission), loaded))
        if not mistake and is_class:
            raise click.UsageError(f"{submission}: to grade a class, give a folder for the results with --out.")
        handed_in = _mistake(mistake, loaded) if mistake else read(submission, loaded)
        with WorkerPool() as workers:
            result = _graded(loaded, handed_in, options, workers)
            _show(result, loaded, json_, verbose)
    except ExerciseError as error:
        _stop(f"The exercise is at fault, not the submission.\n{error}")
    except SandboxUnavailable as error:
        _stop(str(error))
    except HostFault as error:
        _stop(f"The machine or the grader is at fault, not the submission: {error}")
    _write(result, loaded, plot, bag)
    sys.exit(OUR_FAULT if result.outcome == "host-error" else NOT_FULL_MARKS if not result.full_marks else FULL_MARKS)


def _refuse_a_single_program(submission: str) -> None:
    """Refuse `--out` with one program, because it is for the results of a class."""
    if kind_of(submission) in ("python", "notebook", "launch file") and not Path(submission).is_dir():
        raise click.UsageError(
            f"{submission}: this is one submission, and --out is for a class. Leave out --out, or give the folder, "
            "zip file or CSV file of a class."
        )


def _refuse_results_among_submissions(submissions: Path, out: Path) -> None:
    """Refuse a folder for results that the next run would read as a student's."""
    if submissions.is_dir() and out.resolve().is_relative_to(submissions.resolve()):
        raise click.UsageError(f"--out {out}: it is inside {submissions}. Give a folder outside of the submissions.")


def _mistake(name: str, exercise: Exercise) -> Submission:
    """Return a usual mistake as a submission. It loads a Markdown parser, which no other needs."""
    from grader.exercise.mistakes import mistake_of

    return of_mistake(mistake_of(exercise, name), exercise)


def _class(exercise: Exercise, submissions: Path, out: Path, options: dict[str, Any], of_class: dict[str, Any]) -> int:
    """Grade a class. The imports are here so that a single submission is graded sooner."""
    from rich.console import Console

    from grader.classroom.class_run import STOPPED, grade_class
    from grader.classroom.formats.registry import FORMATS
    from grader.classroom.request import ClassRequest, ClusterLost, NoCluster
    from grader.classroom.results import FolderInUse, NotWritable
    from grader.classroom.submissions import SubmissionsError
    from grader.grading.grade import Options

    if of_class["format"] not in ("", *FORMATS):
        raise click.UsageError(f"--format {of_class['format']}: there are {', '.join(FORMATS)}.")
    if of_class["jobs"] and of_class["scheduler"]:
        raise click.UsageError("--jobs: with --scheduler, each worker grades as many at once as its --nthreads says.")
    class_request = ClassRequest(submissions, out, Options(**options), **of_class)
    try:
        return grade_class(exercise, class_request, Console(soft_wrap=False, highlight=False))
    except NotWritable as error:
        _stop(f"{error} Give another folder with --out.")
    except ClusterLost as error:
        _stop(f"{error} Run the same command to continue.")
    except KeyboardInterrupt:
        click.echo("Stopped. This run has graded nothing yet.", err=True)
        return STOPPED
    except (SubmissionsError, FolderInUse, NoCluster) as error:
        raise click.UsageError(str(error)) from None


def _graded(exercise: Exercise, submission: Submission, options: dict[str, Any], workers: WorkerPool) -> Grade:
    """Grade one submission. Import while the worker starts, which takes longer."""
    from grader.grading import Options, grading_of

    return grading_of(exercise, Options(**options), workers).grade(submission)


def _show(result: Grade, exercise: Exercise, as_json: bool, verbose: bool) -> None:
    if as_json:
        from grader.report import as_json as json_report

        click.echo(json_report.as_json(result), nl=False)
        return
    from rich.console import Console

    from grader.report.terminal import show

    show(result, exercise, Console(soft_wrap=False, highlight=False), verbose)


def _write(result: Grade, exercise: Exercise, plot: Path | None, bag: Path | None) -> None:
    try:
        if plot:
            from grader.report.plot import NOTHING, draw

            if not draw(result, exercise, plot):
                click.echo(NOTHING, err=True)
        if bag:
            from grader.report.bag import NoBagWriter, write_bags

            try:
                write_bags(result, bag)
            except NoBagWriter as error:
                _stop(str(error))
    except OSError as error:
        _stop(f"{error.filename}: {error.strerror}")


def _stop(message: str) -> NoReturn:
    click.echo(message, err=True)
    sys.exit(OUR_FAULT)
