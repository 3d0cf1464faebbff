"""Sees to it that nothing is published that students must not see, whatever way it may have got into the pages."""

from __future__ import annotations

from pathlib import Path

from grader.exercise import Exercise, ExerciseError, load
from spinbook.course.course import Course
from spinbook.handout.leaks import leaks
from spinbook.handout.secrets import hidden_names, secrets
from spinbook.problem import Problem, SpinbookError
from spinbook.site.contents import Contents

_MEND = (
    "Students must not see it. Take it out of the chapter, the task or the public checks. A line of the solution that "
    "they may see belongs before # BEGIN SOLUTION."
)


def prove_nothing_leaks(course: Course, contents: Contents) -> None:
    """Raise SpinbookError if a solution, a hidden check or a scenario of any exercise is in what is to be published.

    The pages are looked at before Sphinx gets them: in HTML every line of code is full of marks.
    """
    exercises = [_load(course, name) for name in sorted(course.exercises)]
    taught = "\n".join(contents.taught)
    known = [secret for exercise in exercises for secret in (*secrets(exercise, taught), *hidden_names(exercise))]
    found: dict[Path, str] = {}
    for file, what in leaks(_published(contents), known):
        page = file.removesuffix(".frame").partition(".")[0]
        found.setdefault(contents.origins.get(page, Path("build", file)), what)
    if found:
        told = (Problem(file, None, f"{what} would be published.", _MEND) for file, what in found.items())
        raise SpinbookError(*told)


def _load(course: Course, name: str) -> Exercise:
    try:
        return load(course.root / "exercises" / name)
    except ExerciseError as error:
        raise SpinbookError(Problem(error.file, error.line, error.found, error.mend)) from None


def _published(contents: Contents) -> dict[str, bytes]:
    files: dict[str, str | bytes] = {f"{page.name}{page.suffix}": page.text for page in contents.pages}
    files |= {f"{page.name}.frame": page.frame(contents.openers) for page in contents.pages}
    files |= {f"site/{path}": content for path, content in contents.files.items()}
    files |= {f"launch/{path}": content for path, content in contents.branch.items()}
    # Packed, nothing could be found in them.
    files |= {f"launch/{path}": content for path, content in contents.copies.items()}
    return {path: content.encode() if isinstance(content, str) else content for path, content in files.items()}
