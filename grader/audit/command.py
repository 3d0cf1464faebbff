"""The command `spinbook audit`."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import click
from rich.console import Console

from grader.audit.report import on, show, write_json, write_markdown
from grader.audit.result import Audit, AuditProblem
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import COURSE, find, load
from grader.exercise.mistakes import mistake_of
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
    "--markdown",
    type=click.Path(path_type=Path),
    help="Write the rules of each task as Markdown tables: which mistakes break them, and what these cost.",
)
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
    markdown: Path | None,
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
      spinbook audit --solutions                  does each file of solutions/ get the grade it must?
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
    for option, file in (("--json", json_), ("--html", html), ("--markdown", markdown)):
        _must_be_writable(option, file)
    if solutions and (quick or mutants is not None or seeds):
        raise click.UsageError("--solutions tries no mutants and no seeds: leave out --quick, --mutants and --seeds.")
    options = Options(parallel=parallel) if parallel else Options()
    with _faults_end_it():
        # Workers can import a course's own interfaces only if these are found before the workers start.
        use_near(Path.cwd(), COURSE)
        with WorkerPool() as workers:
            audits = _Audits(options, workers, quick, 0 if solutions else mutants, 1 if solutions else seeds)
            audits.run([find(name, Path.cwd()) for name in exercises] or _all_here())
        audits.write(json_, html)
        if markdown:
            write_markdown(audits.results, markdown)
    sys.exit(PROVED if audits.nothing_to_fix else TO_FIX)


def _must_be_writable(option: str, file: Path | None) -> None:
    if file and (file.is_dir() or not file.absolute().parent.is_dir()):
        text = "that is a folder" if file.is_dir() else f"there is no folder {file.parent}"
        raise click.UsageError(f"{option} {file}: {text}. Name a file in an existing folder.")


@contextlib.contextmanager
def _faults_end_it() -> Iterator[None]:
    """End the command with a message and its exit code if the machine or the grader is at fault, or on Ctrl-C."""
    try:
        yield
    except (SandboxUnavailable, HostFault) as error:
        click.echo(f"The machine or the grader is at fault, not the exercise: {error}", err=True)
        sys.exit(OUR_FAULT)
    except OSError as error:
        click.echo(f"{error.filename}: {error.strerror}", err=True)
        sys.exit(OUR_FAULT)
    except KeyboardInterrupt:
        click.echo("Stopped. The results so far are kept. Run the same command to continue.", err=True)
        sys.exit(STOPPED)


@dataclass
class _Audits:
    """Audits exercises one after another, shows each result and keeps it."""

    options: Options
    workers: WorkerPool
    quick: bool
    mutants: int | None
    seeds: int | None
    results: list[Audit] = field(default_factory=list)
    faulty: list[ExerciseError] = field(default_factory=list)
    console: Console = field(default_factory=lambda: Console(highlight=False))

    @property
    def nothing_to_fix(self) -> bool:
        """Return whether no exercise has a problem."""
        return not self.faulty and not any(result.problems for result in self.results)

    def run(self, folders: Sequence[Path]) -> None:
        """Audit the exercises in these folders."""
        for folder in folders:
            try:
                self._audit(load(folder))
            except ExerciseError as error:
                self.faulty.append(error)
                click.echo(f"{error}\n    The rest of this exercise was not audited.", err=True)

    def write(self, json_: Path | None, html: Path | None) -> None:
        """Write the reports that were asked for. Raises OSError."""
        problems = [_problem(error) for error in self.faulty]
        if json_:
            write_json(self.results, problems, json_)
        if html:
            from grader.audit.report import write_html

            write_html(self.results, problems, html)

    def _audit(self, exercise: Exercise) -> None:
        try:
            from grader.audit.audit import SEEDS, audit
        except ModuleNotFoundError as error:
            if error.name != "libcst":
                raise
            text = "Mutants are made with libcst, which is not installed: pip install 'spinbook[audit]'"
            raise click.UsageError(text) from None
        seeds = self.seeds or SEEDS
        with on(Console(stderr=True)) as progress:
            result = audit(exercise, self.options, self.workers, progress, self.quick, self.mutants, seeds)
        show(result, self.console)
        self.results.append(result)


def _show_mistake(exercises: tuple[str, ...], name: str) -> None:
    if len(exercises) != 1:
        raise click.UsageError("--show needs one EXERCISE.")
    try:
        click.echo(mistake_of(load(find(exercises[0], Path.cwd())), name).source, nl=False)
    except ExerciseError as error:
        raise click.UsageError(str(error)) from None


def _problem(error: ExerciseError) -> AuditProblem:
    problem = error.problem
    return AuditProblem(problem.file, problem.line, problem.problem, problem.fix, about=problem.file.parent.name)


def _all_here() -> list[Path]:
    """Return every exercise of the course in this folder or the nearest one above it."""
    for course in (Path.cwd(), *Path.cwd().parents):
        if exercises := sorted(file.parent for file in course.glob("exercises/*/exercise.toml")):
            return exercises
    raise click.UsageError("There are no exercises here. Start in a course's folder, the one with exercises/ in it.")
