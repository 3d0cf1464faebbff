"""Brings the executed notebooks up to date before the site is made from them."""

from __future__ import annotations

from rich.console import Console

from spinbook.build.execution import Job, execute
from spinbook.build.notebooks import build_notebooks
from spinbook.course.course import Course
from spinbook.interfaces.compiled import compile_course
from spinbook.problem import SpinbookError


def bring_up_to_date(course: Course, console: Console) -> bool:
    """Compile the course's interfaces, build each chapter's notebook, and run those whose code has changed.

    False if something has to be fixed first.
    """
    try:
        compile_course(course)
    except SpinbookError as error:
        console.print(str(error), markup=False)
        return False
    built = list(build_notebooks(course))
    for problem in (problem for item in built for problem in item.problems):
        console.print(str(problem), markup=False)
    if any(item.failed for item in built):
        return False
    jobs = [Job(item.chapter, item.notebook, course.build_folder) for item in built]
    good = True
    with console.status("Looking for chapters to run …") as status:
        for executed in execute(
            jobs, 2, lambda at: status.update(f"Running {at.chapter.stem}: {at.done} of {at.cells} cells")
        ):
            for failure in executed.failures:
                console.print(str(failure), markup=False)
            if not executed.cached and not executed.failures:
                console.print(f"{executed.chapter.stem} ran in {executed.seconds:.0f} s", markup=False)
            good = good and not executed.failures
    return good
