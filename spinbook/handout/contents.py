"""Assembles a handout. It contains what this module lists, and nothing else from the course's folders."""

from __future__ import annotations

import contextlib
import json
import re
import subprocess
import time
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import click
from jinja2 import Environment, PackageLoader, StrictUndefined

from grader.exercise.exercise import Exercise
from grader.exercise.loading import load
from grader.wheels import middleware_wheel
from grader.workers.jobs import ListJob
from grader.workers.pool import HostFault, WorkerPool
from groundwork.files import from_here, write_folder, write_if_changed
from groundwork.problem import Problem
from interface_compiler.wheel_file import EARLIEST, zipped
from spinbook import __version__
from spinbook.build.notebooks import build_notebooks
from spinbook.course.course import Course, find_course
from spinbook.handout.leaks import Secret, authors_code, located, secrets_of_all
from spinbook.handout.pins import declared_pins, imported_packages, jupyterlab_pins, students_pins
from spinbook.handout.student_copy import exercise_files, for_students
from spinbook.handout.wheels import interface_wheels, package_of, requirement, spinbook_wheel
from spinbook.interfaces.definitions import compile_course
from spinbook.problem import SpinbookError, refuse_errors
from spinbook.update.handout import base_files

#: Packages that students need in the instructor's version, so that checks give the same results, if nothing is pinned.
_PINNED = ("ros-{distro}-rclpy", "ros-{distro}-rmw-fastrtps-cpp", "ros-{distro}-common-interfaces")

#: Name in the handout -> template.
_TEMPLATES = {
    "README.md": "README.md.j2",
    "requirements.txt": "requirements.txt.j2",
    "jupyterlab.txt": "jupyterlab.txt.j2",
    "environment.yml": "environment.yml.j2",
    ".devcontainer/devcontainer.json": "devcontainer.json.j2",
}


@dataclass(frozen=True)
class Listing:
    """An exercise as the README lists it: how many checks students may run, and how many run only when graded."""

    name: str
    title: str
    file: str
    public: int
    hidden: int


def guide_files(
    title: str,
    slug: str,
    distro: str,
    wheel: str,
    notebooks: list[str],
    exercises: list[Listing],
    compiled: list[str],
    packages: list[str],
    texts: bytes,
) -> dict[str, bytes]:
    """Return README.md and the files that install, by name.

    `compiled` are names of wheels of compiled code, `packages` what cells and programs import and exercises let
    programs use. `texts` are what students get to read.
    """
    # Plain text and JSON, not HTML.
    environment = Environment(
        loader=PackageLoader("spinbook.handout", "template"),
        autoescape=False,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    values = {
        "title": title,
        "slug": slug,
        "distro": distro,
        "wheel": wheel,
        "notebooks": notebooks,
        "exercises": exercises,
        "pinned": (pinned := students_pins(texts, packages)),
        # Every package is in the list: pip need not look for more.
        "options": " --no-deps --no-compile" if pinned else "",
        "pins": [*(pinned or _pins(distro)), *declared_pins(packages, pinned)],
        "jupyterlab": jupyterlab_pins(),
        "packages": packages,
        "compiled": [requirement(file) for file in compiled],
        "interfaces": any(package_of(file) for file in compiled),
        "version": __version__,
    }
    return {name: environment.get_template(template).render(values).encode() for name, template in _TEMPLATES.items()}


def _pins(distro: str) -> list[str]:
    """Return the versions of ROS 2's wheels that are installed here; none if ROS 2 was sourced."""
    pins = []
    for name in (pattern.format(distro=distro) for pattern in _PINNED):
        with contextlib.suppress(metadata.PackageNotFoundError):
            pins.append(f"{name}=={metadata.version(name)}")
    return pins


@dataclass(frozen=True)
class Handout:
    """A handout: its folder's name, its files by name within it, and its exercises."""

    slug: str
    files: dict[str, bytes]
    exercises: tuple[Listing, ...]


def handout(course: Course) -> Handout:
    """Return the course's handout: notebooks, exercises without what is hidden, and the files that install.

    Raises AuthorError if a chapter or an exercise has an error, or if a secret would be handed out.
    """
    # First: exercises may use the course's own messages.
    compile_course(course)
    notebooks = _notebooks(course)
    files = dict(notebooks)
    exercises = [load(course.root / "exercises" / name) for name in _used(course, notebooks)]
    listings = []
    with WorkerPool() as workers:
        for exercise in exercises:
            copy = exercise_files(exercise, workers)
            listings.append(_listing(exercise, workers))
            files |= {f"exercises/{exercise.name}/{name}": content for name, content in copy.items()}
    cells, own = _code_cells(notebooks), authors_code(files)
    nodes = [cell["source"] for cell in cells if cell["metadata"].get("spinbook", {}).get("kind") == "node"]
    taught = "\n".join([*nodes, own])
    every = [load(course.root / "exercises" / name) for name in sorted(course.exercises)]
    known, names = secrets_of_all(every, taught)
    _prove(files, known + names)
    name, content = spinbook_wheel()
    texts = b"".join(files.values())
    compiled = dict([middleware_wheel(), *interface_wheels(course, [texts]).items()])
    files[f"wheels/{name}"] = content
    files |= {f"wheels/{file}": data for file, data in compiled.items()}
    solutions = (exercise.solution_file.read_text(encoding="utf-8") for exercise in exercises if exercise.solution_file)
    slug = re.sub(r"[^a-z0-9]+", "-", course.title.lower()).strip("-") or "course"
    declared = {package for exercise in exercises for package in exercise.packages}
    named = {package.partition("==")[0] for package in declared}
    also = imported_packages([*(cell["source"] for cell in cells), own, *solutions])
    packages = sorted({*declared, *(package for package in also if package.partition("==")[0] not in named)})
    files |= guide_files(
        course.title,
        slug,
        course.ros_distro,
        name,
        list(notebooks),
        listings,
        sorted(compiled),
        packages,
        texts,
    )
    files |= base_files(files)
    _prove(files, known)
    return Handout(slug, files, tuple(listings))


def _notebooks(course: Course) -> dict[str, bytes]:
    built = list(build_notebooks(course))
    refuse_errors(problem for item in built for problem in item.problems)
    return {
        item.notebook.name: for_students(item.notebook.read_text(encoding="utf-8"), course.repository).encode()
        for item in built
    }


def _code_cells(notebooks: dict[str, bytes]) -> list[dict[str, Any]]:
    cells = (cell for content in notebooks.values() for cell in json.loads(content)["cells"])
    return [cell for cell in cells if cell["cell_type"] == "code"]


def _used(course: Course, notebooks: dict[str, bytes]) -> list[str]:
    """Return the exercises that are in the chapters, in their order: one that is not set yet is not handed out."""
    text = b"".join(notebooks.values()).decode()
    places = {name: text.find(f'"exercise": "{name}"') for name in course.exercises}
    return sorted((name for name, place in places.items() if place >= 0), key=lambda name: places[name])


def _listing(exercise: Exercise, workers: WorkerPool) -> Listing:
    checks = workers.do(ListJob(exercise))
    hidden = sum(check.hidden for check in checks)
    return Listing(exercise.name, exercise.title, exercise.file_name, len(checks) - hidden, hidden)


def _prove(files: dict[str, bytes], known: list[Secret]) -> None:
    """Raise SpinbookError if there is a secret in any file."""
    fix = (
        "Students must not see it. Take it out of the chapter, the task or the public checks. A line of the solution "
        "that they may see belongs before # BEGIN SOLUTION. "
        "Exercises that are in no chapter count, too."
    )
    problems = []
    for leak in located(files, known):
        place, file = f" ({leak.at})" if leak.at else "", Path("build", "handout", leak.file)
        problems.append(Problem(file, leak.line, f"{leak.what} would be in it{place}.", fix))
    refuse_errors(problems)


@click.command("handout", context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
def command(start: Path) -> None:
    """Write what students get: a folder and a zip, in build/handout/.

    In it are the notebooks, the exercises with starters and public checks, a README with three steps, and what installs
    Spinbook and ROS 2. Solutions, hidden checks and their scenarios, and comments in chapters are not: every file
    is searched for them before anything is written. The same course gives the same bytes.

    Exit codes: 0 written, 1 a chapter or an exercise has to be fixed first.
    """
    course = find_course(start)
    try:
        made = handout(course)
    except HostFault as error:
        problem = f"a solution could not be run because of a fault of this machine: {error}"
        raise SpinbookError(Problem(course.root, None, problem, "Try again.")) from None
    folder = course.build_folder / "handout" / made.slug
    archive = folder.with_suffix(".zip")
    write_folder(folder, made.files)
    inside = {f"{made.slug}/{name}": content for name, content in made.files.items()}
    write_if_changed(archive, zipped(inside, date=_date(course)))
    for exercise in made.exercises:
        click.echo(
            f"  {exercise.name}: {exercise.public} checks that students can run, {exercise.hidden} that stay hidden"
        )
    click.echo(f"{len(made.files)} files, no solution and no hidden check among them.")
    click.echo(f"Folder: {from_here(folder)}/\nZip:    {from_here(archive)} ({archive.stat().st_size / 1e6:.1f} MB)")


def _date(course: Course) -> tuple[int, ...]:
    """Return when the course was last committed (UTC); without Git, always the same date."""
    asked = ["git", "-C", str(course.root), "log", "-1", "--format=%ct", "--", "."]
    try:
        commit = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    except OSError:
        commit = ""
    return max(time.gmtime(int(commit or 0))[:6], EARLIEST)
