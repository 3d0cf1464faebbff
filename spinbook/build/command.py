"""`spinbook build`: chapters become notebooks; with `--execute` they are run."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars

from groundwork.files import from_here
from groundwork.problem import Problem
from groundwork.words import counted, did_you_mean
from spinbook.build.execution import DEADLINE_S, ExecutionResult, NotebookJob, NotebookProgress, execute
from spinbook.build.notebooks import BuildResult, build_notebooks, report
from spinbook.course.course import FILE, Course, find_course
from spinbook.interfaces.definitions import compile_course
from spinbook.problem import SpinbookError

#: Nodes wait more than they compute: two notebooks per core keep a machine busy and responsive.
_AT_ONCE = 2 * (os.cpu_count() or 1)


@click.command()
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
@click.option("--execute", "run", is_flag=True, help="Run every notebook, with real nodes, and keep its outputs.")
@click.option(
    "--jobs", type=click.IntRange(1, 50), default=_AT_ONCE, show_default=True, help="How many notebooks run at once."
)
@click.option(
    "--deadline",
    type=click.FloatRange(1),
    default=DEADLINE_S,
    show_default=True,
    help="Time limit per notebook, in seconds.",
)
@click.option(
    "--strict", "is_strict", is_flag=True, help="Treat code that is shown but not run, and errors of nodes, as errors."
)
@click.option("--again", is_flag=True, help="Also run notebooks that have not changed since their last good run.")
@click.argument("chapters", nargs=-1)
def build(
    start: Path, run: bool, jobs: int, deadline: float, is_strict: bool, again: bool, chapters: tuple[str, ...]
) -> None:
    """Make a notebook of each chapter that course.toml lists, in build/notebooks/.

    With --execute, also runs each notebook, isolated from the others, and saves it with outputs in
    build/executed/. It does not run a chapter again whose code has not changed since a good run. CHAPTERS, such as
    03-nodes-and-topics, run only those.

    Code that can't run here is shown with the reason, and counted at the end; `spinbook lint` lists each place. What
    goes wrong in a node after its cell has ended is reported, too. With --strict, for the CI of your own course, both
    are errors; write `expect-error` on a fence whose node is meant to fail.

    Exit code: 0 no errors, 1 a chapter has an error or a cell failed; the other chapters are built anyway.
    """
    course = find_course(start)
    console = Console(soft_wrap=True, highlight=False)
    compiled = _compile_interfaces(console, course)
    built = list(build_notebooks(course, is_strict=is_strict))
    unknown = _without_match(built, chapters)
    _report_built(console, built)
    for problem in unknown:
        console.print(str(problem), markup=False, style="red")
    failed = not compiled or bool(unknown)
    broken = [item.name for item in built if item.failed]
    if run and compiled:
        chosen = [item for item in built if not item.failed and _is_chosen(item, chapters)]
        try:
            broken += _execute(console, course, chosen, jobs, deadline, again, is_strict)
        except KeyboardInterrupt:
            console.print("Interrupted: the notebooks that were running have been ended; finished ones are kept.")
            sys.exit(130)
    folder = course.build_folder / ("executed" if run else "notebooks")
    console.print(f"Notebooks: {from_here(folder)}/", markup=False)
    if broken:
        console.print(f"Failed: {', '.join(broken)}. The reasons are above.", markup=False, style="red")
    sys.exit(1 if failed or broken else 0)


def _compile_interfaces(console: Console, course: Course) -> bool:
    """Compile the course's interfaces and report what is wrong in them. Return whether nothing is."""
    try:
        compiled = compile_course(course)
    except SpinbookError as error:
        for problem in error.problems:
            console.print(str(problem), markup=False, style="red")
        return False
    if compiled is not None:
        how = "compiled" if compiled.fresh else "unchanged"
        console.print(f"Interfaces {how}: {', '.join(compiled.packages)}", markup=False)
    return True


def _is_chosen(item: BuildResult, chapters: tuple[str, ...]) -> bool:
    return not chapters or any(name in {item.name, item.chapter.stem, *_paths(item.chapter)} for name in chapters)


def _paths(chapter: Path) -> set[str]:
    """Return the names by which a user in the course's folder or in a chapter's folder may call a chapter."""
    return {chapter.as_posix(), chapter.name, f"./{chapter.as_posix()}", chapter.with_suffix("").as_posix()}


def _without_match(built: list[BuildResult], chapters: tuple[str, ...]) -> list[Problem]:
    """Return the names that do not belong to any chapter."""
    known = [item.name for item in built]
    unknown = [name for name in chapters if not any(_is_chosen(item, (name,)) for item in built)]
    otherwise = f"The chapters are: {', '.join(known)}."
    return [
        Problem(FILE, None, f"there is no chapter `{name}`.", did_you_mean(name, known, otherwise, "`{}`"))
        for name in unknown
    ]


def _report_built(console: Console, built: list[BuildResult]) -> None:
    report(console, built)
    made = sum(item.fresh and not item.failed for item in built)
    broken = sum(item.failed for item in built)
    console.print(
        f"{len(built)} chapters: {made} built, {len(built) - made - broken} unchanged, {broken} with errors",
        markup=False,
    )


def _execute(
    console: Console,
    course: Course,
    built: list[BuildResult],
    at_once: int,
    deadline_s: float,
    again: bool,
    is_strict: bool,
) -> list[str]:
    """Run notebooks with a progress bar. Return the names of those that failed; with `is_strict`, an error of a node
    counts.
    """
    jobs = [NotebookJob(item.chapter, item.notebook, course.build_folder, deadline_s) for item in built]
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("cells"),
        TimeElapsedColumn(),
    )
    failed = []
    with Bars(*columns, console=console, transient=True) as bars:
        tasks = {job.chapter: bars.add_task(job.name, total=None, start=False, visible=False) for job in jobs}

        def on_progress(progress: NotebookProgress) -> None:
            task = tasks[progress.chapter]
            bars.start_task(task)
            bars.update(task, total=progress.cells or None, completed=progress.done, visible=True)

        for executed in execute(jobs, at_once, on_progress, again=again):
            bars.remove_task(tasks[executed.chapter])
            _report_executed(console, executed)
            if executed.failures or (is_strict and executed.node_errors):
                failed.append(executed.file.name.removesuffix(".ipynb"))
    return failed


def _report_executed(console: Console, executed: ExecutionResult) -> None:
    name = executed.file.name.removesuffix(".ipynb")
    if executed.node_errors and not executed.failures:
        since = "unchanged since its last run" if executed.cached else f"ran in {executed.seconds:.0f} s"
        trouble = f"but something went wrong in its nodes or threads ({counted(len(executed.node_errors), 'report')})"
        console.print(f"  ✗ {name}: {since}, {trouble}", markup=False, style="red")
    elif executed.cached:
        console.print(f"  ✓ {name}: unchanged since its last run", markup=False)
    elif not executed.failures:
        console.print(f"  ✓ {name}: ran in {executed.seconds:.0f} s", markup=False, style="green")
    else:
        console.print(f"  ✗ {name}: {counted(len(executed.failures), 'cell')} failed", markup=False, style="red")
        for failure in executed.failures:
            console.print(str(failure), markup=False)
    for warning in (*executed.node_errors, *executed.warnings):
        console.print(str(warning), markup=False, style="yellow")
