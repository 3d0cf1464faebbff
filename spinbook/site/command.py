"""`spinbook site`: the course's website."""

from __future__ import annotations

import sys
from pathlib import Path

import click
from rich.console import Console

from spinbook.course.course import Course, find_course
from spinbook.site.build import Site, build_site


@click.command()
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
def site(start: Path) -> None:
    """Make the course's website in build/site/, from the notebooks as they ran."""
    course = find_course(start)
    console = Console(soft_wrap=True, highlight=False)
    report(console, course, build_site(course, lambda page: None))


def report(console: Console, course: Course, built: Site) -> None:
    """Say what came of it."""
    for problem in built.problems:
        console.print(str(problem), markup=False)
    console.print(f"{built.pages} pages, {len(built.made)} made, {built.seconds:.1f} s", markup=False)
    sys.exit(0)
