"""`spinbook trace`: runs one scenario of an exercise, and shows what happened, also if the solution fails."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import click
from rich.console import Console

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import find, load
from grader.exercise.mistakes import mistake_of
from grader.grading.grade import Grade, Options
from grader.grading.grading import Grading
from grader.grading.reference import solution_file
from grader.grading.scenario_runner import ScenarioRunner
from grader.report.bag import NoBagWriter, write_bags
from grader.report.terminal import show
from grader.report.timeline import lines_of
from grader.sandbox.isolation import choose
from grader.scenario.declared import declared
from grader.scenario.scenario import Step
from grader.submission.reader import of_mistake, of_source, read
from grader.submission.submission import Submission
from grader.workers.pool import HostFault, WorkerPool, leave_cpus_to_workers
from ros_in_python.svg_file import SvgFile

#: How often --watch looks whether a file was saved (s).
_LOOK_EVERY_S = 0.3


@dataclass(frozen=True)
class Trace:
    """What to run and show: see the command's options."""

    exercise: Path
    program: str
    mistake: str
    scenario: str
    only: tuple[str, ...]
    everything: bool
    plot: Path | None
    bag: Path | None
    log: bool
    seed: int


@click.command("trace", context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.argument("program", default="")
@click.option("--scenario", "-s", default="", metavar="NAME", help="The scenario to run.  [default: the first]")
@click.option("--mistake", default="", metavar="NAME", help="Run a usual mistake from the exercise's solutions folder.")
@click.option("--only", multiple=True, metavar="TEXT", help="Show only what has this in its name, such as a topic.")
@click.option("--all", "everything", is_flag=True, help="Show every message, also of topics with many.")
@click.option("--plot", type=SvgFile(), help="Draw the program's output over the solution's (.svg).")
@click.option("--bag", type=click.Path(path_type=Path), help="Write the run as a rosbag2 (MCAP) into this folder.")
@click.option("--log", is_flag=True, help="Show what the program logged, too.")
@click.option("--seed", default=1, show_default=True, help="The seed for scenarios with random values.")
@click.option("--watch", is_flag=True, help="Run again whenever a file of the exercise or the program is saved.")
def trace(exercise: str, watch: bool, **options: object) -> None:
    """Run one scenario of an EXERCISE and show what happened in it: messages, calls, goals, parameters, the world.

    PROGRAM is the author's solution unless another one is given. Then the checks that need only this scenario judge it.
    Nothing has to be right for it: use it while you write an exercise and tune a world.

    \b
      spinbook trace tank                            the solution, in the first scenario
      spinbook trace tank --scenario leak --log      another scenario, with the log
      spinbook trace tank --only /level --all        every message on /level
      spinbook trace tank mine.py --plot leak.svg    another program; the solution is drawn, too
      spinbook trace tank --watch                    again after each save

    Exit codes: 0 it ran, 1 the program ended with an error, 2 wrong usage, 3 a fault of the exercise or the machine.
    """
    leave_cpus_to_workers()
    asked = Trace(exercise=find(exercise, Path.cwd()), **options)  # type: ignore[arg-type]
    with WorkerPool() as workers:
        code = _traced(asked, workers)
        for name in _saved(asked) if watch else ():
            click.echo(f"\n--- {name} was saved: again ---\n")
            code = _traced(asked, workers)
    sys.exit(code)


def _traced(asked: Trace, workers: WorkerPool) -> int:
    """Run and show; return the exit code."""
    try:
        exercise = load(asked.exercise)
        grade, steps = _run(asked, exercise, workers)
    except (ExerciseError, HostFault) as error:
        click.echo(str(error), err=True)
        return 3
    _show(asked, exercise, grade, steps)
    return 0 if grade.outcome == "graded" else 1


def _run(asked: Trace, exercise: Exercise, workers: WorkerPool) -> tuple[Grade, tuple[Step, ...]]:
    """Return the grade in one scenario, and the scenario's steps."""
    options = Options(seed=asked.seed)
    every = declared(exercise, asked.seed)
    names = [scenario.name for scenario in every]
    if asked.scenario and asked.scenario not in names:
        raise click.UsageError(f"--scenario {asked.scenario}: the scenarios are {', '.join(names)}.")
    runner = ScenarioRunner(exercise, every, choose(None), options, workers, partly=True)
    name = asked.scenario or names[0]
    runner = runner.only(name)
    solution = of_source("the solution", solution_file(exercise).read_bytes(), exercise)
    references = runner.run(solution)
    grading = Grading(runner, references)
    program = _program(asked, exercise)
    recordings = runner.run(program) if program and program.program else references
    return grading.judge(program or solution, recordings), every[names.index(name)].steps


def _program(asked: Trace, exercise: Exercise) -> Submission | None:
    """Return the program that was named; None for the solution."""
    if asked.mistake:
        return of_mistake(mistake_of(exercise, asked.mistake), exercise)
    return read(asked.program, exercise) if asked.program else None


def _show(asked: Trace, exercise: Exercise, grade: Grade, steps: tuple[Step, ...]) -> None:
    (scenario, recording), *_ = grade.recordings.items()
    click.echo(f"scenario: {scenario}")
    for line in lines_of(recording, asked.only, asked.everything, steps):
        click.echo(line)
    click.echo()
    show(grade, exercise, Console(soft_wrap=False, highlight=False), asked.log)
    try:
        if asked.plot:
            from grader.report.plot import NOTHING, draw

            if not draw(grade, exercise, asked.plot, scenario):
                click.echo(NOTHING, err=True)
        if asked.bag:
            write_bags(grade, asked.bag)
    except (NoBagWriter, OSError) as error:
        click.echo(f"not written: {error}", err=True)


def _saved(asked: Trace) -> Iterator[str]:
    """Yield the name of a file whenever one was saved, until Ctrl-C."""
    known = _times(asked)
    click.echo("\nwaiting for a file to be saved; Ctrl-C ends it")
    while True:
        try:
            time.sleep(_LOOK_EVERY_S)
        except KeyboardInterrupt:
            return
        now = _times(asked)
        if changed := [name for name in now if now[name] != known.get(name)] or [*(known.keys() - now.keys())]:
            known = now
            yield Path(changed[0]).name


def _times(asked: Trace) -> dict[str, int]:
    """Return when each file was saved that a run depends on."""
    exercise = asked.exercise.resolve()
    folders = [exercise, exercise.parent.parent / "solutions" / exercise.name]
    files = [file for folder in folders for file in folder.rglob("*")]
    files += [Path(asked.program)] if asked.program else []
    return {str(file): file.stat().st_mtime_ns for file in files if file.is_file() and "__pycache__" not in file.parts}
