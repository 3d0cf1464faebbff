"""The command `spinbook audit`."""

from __future__ import annotations

import sys
from pathlib import Path

import click
from rich.console import Console

from grader.audit.report import on, show, write_json
from grader.audit.result import Audit, AuditProblem
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import COURSE, NoExercise, find, load
from grader.exercise.mistakes import NoMistake, mistake_of
from grader.grading.grade import Options
from grader.sandbox.program import SandboxUnavailable
from grader.workers.pool import HostFault, WorkerPool, leave_cpus_to_workers
from interface_compiler.near import use_near

#: Exit codes, besides click's 2 for usage and a shell's 130 for Ctrl-C.
PROVED, TO_FIX, OUR_FAULT, STOPPED = 0, 1, 3, 130


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercises", nargs=-1, metavar="[EXERCISE]…")
@click.option(
    "--quick", is_flag=True, help="Only the mistakes and a sample of the mutants. Use this after every change."
)
@click.option("--solutions", is_flag=True, help="Only the files of solutions/, with every check; no mutants.")
@click.option("--mutants", type=click.IntRange(0), help="Try at most this many mutants.")
@click.option(
    "--seeds", type=click.IntRange(1), help="Number of seeds for scenarios with random values.  [default: 20]"
)
@click.option("--json", "json_", type=click.Path(path_type=Path), help="Write the report as JSON, for programs.")
@click.option("--html", type=click.Path(path_type=Path), help="Write the report as an HTML page.")
@click.option(
    "--show", "shown", metavar="NAME", help="Print the whole program of one usual mistake, and audit nothing."
)
@click.option("--parallel", type=click.IntRange(1, 64), help="How many runs at once.  [default: twice the cores]")
def audit(
    exercises: tuple[str, ...],
    quick: bool,
    solutions: bool,
    mutants: int | None,
    seeds: int | None,
    json_: Path | None,
    html: Path | None,
    shown: str | None,
    parallel: int | None,
) -> None:
    """Show that the checks of each EXERCISE catch what is wrong and pass what is right.

    Right solutions must get full marks, whatever the random numbers of a scenario are. The starter, an empty file and
    an idle node must get no points. Each common mistake must fail the checks that it names. Then the audit changes the
    solution in one place after another. A check must catch every such mutant whose messages differ; the audit shows
    those that no check catches.

    \b
      spinbook audit                              every exercise of the course
      spinbook audit joint_velocity               one
      spinbook audit --quick                      a sample, in seconds
      spinbook audit --solutions                  is each file of solutions/ graded as it has to be?
      spinbook audit joint_velocity --html a.html how much each check catches, and what it costs
      spinbook audit joint_velocity --show fixed_dt   one of its usual mistakes, as a whole program

    EXERCISE is a name in the course's folder exercises/, or the path of an exercise's folder. The first audit of an
    exercise takes minutes. The results are kept until something that they depend on changes, so an audit after a change
    takes seconds, and an interrupted audit continues where it stopped.

    Exit codes: 0 nothing to fix, 1 there is something to fix, 2 wrong usage, 3 a fault of the machine or the grader.
    """
    if shown is not None:
        _show_mistake(exercises, shown)
        return
    leave_cpus_to_workers()
    for option, file in (("--json", json_), ("--html", html)):
        if file and (file.is_dir() or not file.absolute().parent.is_dir()):
            text = "that is a folder" if file.is_dir() else f"there is no folder {file.parent}"
            raise click.UsageError(f"{option} {file}: {text}. Name a file in an existing folder.")
    if solutions and (quick or mutants is not None or seeds):
        raise click.UsageError("--solutions tries no mutants and no seeds: leave out --quick, --mutants and --seeds.")
    if solutions:
        mutants, seeds = 0, 1
    options = Options(parallel=parallel) if parallel else Options()
    audits: list[Audit] = []
    faulty: list[ExerciseError] = []
    console = Console(highlight=False)
    try:
        # Workers can import a course's own interfaces only if these are found before the workers start.
        use_near(Path.cwd(), COURSE)
        with WorkerPool() as workers:
            for folder in [_folder(name) for name in exercises] or _all_here():
                try:
                    audits.append(_audited(load(folder), options, workers, console, quick, mutants, seeds))
                except ExerciseError as error:
                    faulty.append(error)
                    click.echo(f"{error}\n    The rest of this exercise was not audited.", err=True)
        if json_:
            write_json(audits, [_problem(error) for error in faulty], json_)
        if html:
            from grader.audit.report import write_html

            write_html(audits, [_problem(error) for error in faulty], html)
    except (SandboxUnavailable, HostFault) as error:
        click.echo(f"The machine or the grader is at fault, not the exercise: {error}", err=True)
        sys.exit(OUR_FAULT)
    except OSError as error:
        click.echo(f"{error.filename}: {error.strerror}", err=True)
        sys.exit(OUR_FAULT)
    except KeyboardInterrupt:
        click.echo("Stopped. The results so far are kept. Run the same command to continue.", err=True)
        sys.exit(STOPPED)
    sys.exit(TO_FIX if faulty or any(result.problems for result in audits) else PROVED)


def _show_mistake(exercises: tuple[str, ...], name: str) -> None:
    if len(exercises) != 1:
        raise click.UsageError("--show needs one EXERCISE.")
    try:
        click.echo(mistake_of(load(_folder(exercises[0])), name).source, nl=False)
    except (NoMistake, ExerciseError) as error:
        raise click.UsageError(str(error)) from None


def _audited(
    exercise: Exercise,
    options: Options,
    workers: WorkerPool,
    console: Console,
    quick: bool,
    mutants: int | None,
    seeds: int | None,
) -> Audit:
    try:
        from grader.audit.audit import SEEDS
        from grader.audit.audit import audit as audit_one
    except ModuleNotFoundError as error:
        if error.name != "libcst":
            raise
        text = "Mutants are made with libcst, which is not installed: pip install 'spinbook[audit]'"
        raise click.UsageError(text) from None
    with on(Console(stderr=True)) as progress:
        result = audit_one(exercise, options, workers, progress, quick, mutants, seeds or SEEDS)
    show(result, console)
    return result


def _problem(error: ExerciseError) -> AuditProblem:
    problem = error.problem
    return AuditProblem(problem.file, problem.line, problem.problem, problem.fix, about=problem.file.parent.name)


def _folder(exercise: str) -> Path:
    try:
        return find(exercise, Path.cwd())
    except NoExercise as error:
        raise click.UsageError(str(error)) from None


def _all_here() -> list[Path]:
    """Every exercise of this folder's course, or of the nearest one above it."""
    for course in (Path.cwd(), *Path.cwd().parents):
        if found := sorted(file.parent for file in course.glob("exercises/*/exercise.toml")):
            return found
    raise click.UsageError("There are no exercises here. Start in a course's folder, the one with exercises/ in it.")
