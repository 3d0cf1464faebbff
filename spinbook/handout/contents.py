"""Puts a handout together. What is in it is listed here: whatever else lies in the course's folders stays there."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from grader.crew import Crew
from grader.crew.jobs import ListJob
from grader.exercise import Exercise, ExerciseError, load
from spinbook.build.notebooks import build_notebooks
from spinbook.course.course import Course
from spinbook.handout.exercise import exercise_files
from spinbook.handout.guide import Listing, guide_files
from spinbook.handout.interface_wheels import interface_wheels
from spinbook.handout.leaks import located
from spinbook.handout.notebook import for_students
from spinbook.handout.secrets import Secret, hidden_names, secrets
from spinbook.handout.wheel import wheel
from spinbook.interfaces.compiled import compile_course
from spinbook.problem import Problem, SpinbookError
from spinbook.update.base import base_files


@dataclass(frozen=True)
class Handout:
    """A handout: its folder's name, its files by name within it, and its exercises."""

    slug: str
    files: dict[str, bytes]
    exercises: tuple[Listing, ...]


def handout(course: Course) -> Handout:
    """The course's handout: notebooks, exercises without what is hidden, and the means to install.

    Raises SpinbookError where a chapter or an exercise has an error, or where a secret would be handed out.
    """
    # First: exercises may be on the course's own messages.
    compile_course(course)
    notebooks = _notebooks(course)
    files = dict(notebooks)
    exercises = [_load(course, name) for name in sorted(_used(course, notebooks))]
    listings = []
    with Crew() as crew:
        for exercise in exercises:
            try:
                copy = exercise_files(exercise, crew)
                listings.append(_listing(exercise, crew))
            except ExerciseError as error:
                raise SpinbookError(Problem(error.file, error.line, error.found, error.mend)) from None
            files |= {f"exercises/{exercise.name}/{name}": content for name, content in copy.items()}
    taught = "\n".join(_nodes(notebooks))
    every = [_load(course, name) for name in sorted(course.exercises)]
    known = [secret for exercise in every for secret in secrets(exercise, taught)]
    _prove(files, known + [secret for exercise in every for secret in hidden_names(exercise)])
    name, content = wheel()
    compiled = interface_wheels(course, files.values())
    files[f"wheels/{name}"] = content
    files |= {f"wheels/{file}": data for file, data in compiled.items()}
    slug = re.sub(r"[^a-z0-9]+", "-", course.title.lower()).strip("-") or "course"
    files |= guide_files(course.title, slug, course.ros_distro, name, sorted(notebooks), listings, sorted(compiled))
    files |= base_files(files)
    _prove(files, known)
    return Handout(slug, files, tuple(listings))


def _notebooks(course: Course) -> dict[str, bytes]:
    built = list(build_notebooks(course))
    problems = [problem for item in built for problem in item.problems if problem.is_error]
    if problems:
        raise SpinbookError(*problems)
    return {
        item.notebook.name: for_students(item.notebook.read_text(encoding="utf-8"), course.repository).encode()
        for item in built
    }


def _nodes(notebooks: dict[str, bytes]) -> Iterator[str]:
    """The code of the chapters' own nodes."""
    for content in notebooks.values():
        for cell in json.loads(content)["cells"]:
            if cell["metadata"].get("spinbook", {}).get("kind") == "node":
                yield cell["source"]


def _used(course: Course, notebooks: dict[str, bytes]) -> set[str]:
    """The exercises that the chapters have in them: one that is not set yet is not handed out."""
    text = b"".join(notebooks.values()).decode()
    return {name for name in course.exercises if f'"exercise": "{name}"' in text}


def _load(course: Course, name: str) -> Exercise:
    try:
        return load(course.root / "exercises" / name)
    except ExerciseError as error:
        raise SpinbookError(Problem(error.file, error.line, error.found, error.mend)) from None


def _listing(exercise: Exercise, crew: Crew) -> Listing:
    checks = crew.do(ListJob(exercise))
    hidden = sum(check.hidden for check in checks)
    return Listing(exercise.name, exercise.title, exercise.file_name, len(checks) - hidden, hidden)


def _prove(files: dict[str, bytes], known: list[Secret]) -> None:
    """See to it that no secret is in any file."""
    mend = (
        "Students must not see it. Take it out of the chapter, the task or the public checks. A line of the solution "
        "that they may see belongs before # BEGIN SOLUTION. "
        "Exercises that no chapter holds count, too."
    )
    folder = Path("build", "handout")
    problems = []
    for leak in located(files, known):
        place = f" ({leak.at})" if leak.at else ""
        problems.append(Problem(folder / leak.file, leak.line, f"{leak.what} would be in it{place}.", mend))
    if problems:
        raise SpinbookError(*problems)
