"""Brings the executed notebooks up to date before the site is made from them."""

from __future__ import annotations

from rich.console import Console

from spinbook.build.execution import Job, execute
from spinbook.build.notebooks import build_notebooks
from spinbook.course.course import Course
from spinbook.course.obstacles import ranked
from spinbook.interfaces.compiled import compile_course
from spinbook.problem import SpinbookError


def bring_up_to_date(course: Course, console: Console, *, is_strict: bool) -> bool:
    """Compile the course's interfaces, build each chapter's notebook, and run those whose code has changed.

    False if something has to be fixed first; `is_strict` says that a cell that fails, or code that is shown and not
    run, has to be.
    """
    try:
        compile_course(course)
    except SpinbookError as error:
        console.print(str(error), markup=False)
        return False
    built = list(build_notebooks(course, is_strict=is_strict))
    problems = [problem for item in built for problem in item.problems]
    for problem in problems:
        if problem.is_error or not problem.group:
            console.print(str(problem), markup=False)
    for line in ranked([problem for problem in problems if not problem.is_error]):
        console.print(line, markup=False)
    if any(item.failed for item in built):
        return False
    jobs = [Job(item.chapter, item.notebook, course.build_folder) for item in built]
    good = True
    with console.status("Looking for chapters to run …") as status:
        for executed in execute(
            jobs, 2, lambda at: status.update(f"Running {at.chapter}: {at.done} of {at.cells} cells")
        ):
            for failure in executed.failures:
                console.print(str(failure), markup=False)
            for warning in executed.warnings:
                console.print(str(warning), markup=False)
            if not executed.cached and not executed.failures:
                console.print(f"{executed.chapter} ran in {executed.seconds:.0f} s", markup=False)
            good = good and not (is_strict and executed.failures)
    return good
