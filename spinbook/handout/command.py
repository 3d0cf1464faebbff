"""`spinbook handout`: what students get."""

from __future__ import annotations

import shutil
from pathlib import Path

import click

from grader.files import write_if_changed
from grader.workers.pool import HostFault
from interface_compiler.archive import zipped
from spinbook.course.course import find_course
from spinbook.handout.contents import Handout, handout
from spinbook.problem import Problem, SpinbookError


@click.command("handout", context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
def command(start: Path) -> None:
    """Write what students get: a folder and a zip, in build/handout/.

    In it are the notebooks, the exercises with starters and public checks, a README with three steps, and what installs
    Spinbook and ROS 2. Solutions, hidden checks and their scenarios, and comments in chapters are not: every file is
    looked through for them before anything is written. The same course gives the same bytes.

    Exit codes: 0 written, 1 a chapter or an exercise has to be fixed first.
    """
    course = find_course(start)
    try:
        made = handout(course)
    except HostFault as error:
        found = f"a solution could not be run because of a fault of this machine: {error}"
        raise SpinbookError(Problem(course.root, None, found, "Try again.")) from None
    folder = course.build_folder / "handout" / made.slug
    archive = folder.with_suffix(".zip")
    _write(folder, made)
    write_if_changed(archive, zipped({f"{made.slug}/{name}": content for name, content in made.files.items()}))
    for exercise in made.exercises:
        click.echo(
            f"  {exercise.name}: {exercise.public} checks that students can run, {exercise.hidden} that stay hidden"
        )
    click.echo(f"{len(made.files)} files, no solution and no hidden check among them.")
    click.echo(f"Folder: {_shown(folder)}/\nZip:    {_shown(archive)} ({archive.stat().st_size / 1e6:.1f} MB)")


def _write(folder: Path, made: Handout) -> None:
    """Make the folder hold these files and no others."""
    for file in sorted(folder.rglob("*"), reverse=True):
        if file.is_file() and file.relative_to(folder).as_posix() not in made.files:
            file.unlink()
        elif file.is_dir() and not any(file.iterdir()):
            shutil.rmtree(file)
    for name, content in made.files.items():
        write_if_changed(folder / name, content)


def _shown(path: Path) -> Path:
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
