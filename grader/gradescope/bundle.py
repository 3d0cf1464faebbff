"""The zip that is uploaded to Gradescope as an autograder: the grader, one exercise with its solution, two scripts."""

from __future__ import annotations

import io
import shlex
import zipfile
from collections.abc import Iterator
from pathlib import Path

from grader.exercise import Exercise
from grader.grading.reference import solution_file
from grader.sandbox import Isolation
from interface_compiler import activation
from interface_compiler.building import DEFINITIONS

#: Where this software's own source is: the folder with pyproject.toml.
SOURCE = Path(__file__).parents[2]

#: What of it the container needs.
NEEDED = ("pyproject.toml", "README.md", "LICENSE", "constraints.txt", "constraints-ros.txt")

#: The same content gives the same bytes: every entry has the earliest date that a zip can name.
DATE = (1980, 1, 1, 0, 0, 0)


class NoSource(Exception):
    """Raised where the software is installed without its source, from which a container could install it."""


def bundle(exercise: Exercise, isolation: Isolation | None = None) -> bytes:
    """The zip's bytes, the same each time for the same content.

    Of the solutions only `solution.py` is in it, and no student can read it there but by breaking out of the sandbox.
    `isolation` is the level at which students' programs are run, None for the strongest that works in the container.
    Raises `NoSource`, and `ExerciseError` where there is no solution.
    """
    if not (SOURCE / "pyproject.toml").exists():
        raise NoSource("Spinbook was installed without its source. Run this in a checkout of it.")
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, script in (("setup.sh", "setup.sh"), ("run_autograder", "run_autograder.sh")):
            _add(archive, name, _script(script, exercise, isolation).encode(), 0o755)
        for name, file in _files(exercise):
            _add(archive, f"course/{name}", file.read_bytes(), 0o644)
    return out.getvalue()


def _script(file: str, exercise: Exercise, isolation: Isolation | None) -> str:
    text = Path(__file__).with_name(file).read_text(encoding="utf-8")
    level = shlex.quote(isolation.value) if isolation else ""
    return text.replace("@EXERCISE@", shlex.quote(exercise.name)).replace("@ISOLATION@", level)


def _files(exercise: Exercise) -> Iterator[tuple[str, Path]]:
    """Every file of the container's course, with its name there."""
    for name in NEEDED:
        yield name, SOURCE / name
    for package in ("grader", "spinbook", "rmw_lockstep", "interface_compiler"):
        for file in _within(SOURCE / package):
            yield f"{package}/{file.relative_to(SOURCE / package)}", file
    for file in _within(exercise.folder):
        yield f"exercises/{exercise.name}/{file.relative_to(exercise.folder)}", file
    yield f"solutions/{exercise.name}/solution.py", solution_file(exercise)
    # The course's own messages, which the container compiles for its own Python.
    course = exercise.folder.parent.parent / "course.toml"
    if course.is_file():
        yield course.name, course
    for prefix in activation.active():
        for file in _within(prefix / DEFINITIONS):
            yield f"interfaces/{file.relative_to(prefix / DEFINITIONS)}", file


def _within(folder: Path) -> list[Path]:
    """The files below `folder`, without caches and hidden files."""
    files = [file for file in folder.rglob("*") if file.is_file() and file.suffix != ".pyc"]
    kept = [file for file in files if not any(part.startswith(".") for part in file.relative_to(folder).parts)]
    return sorted(file for file in kept if "__pycache__" not in file.parts)


def _add(archive: zipfile.ZipFile, name: str, content: bytes, mode: int) -> None:
    entry = zipfile.ZipInfo(name, DATE)
    entry.external_attr = (0o100000 | mode) << 16
    entry.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(entry, content)
