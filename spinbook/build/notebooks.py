"""Builds the notebooks of a course, those whose chapters changed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from grader.exercise import ExerciseError
from spinbook.build.digest import code_digest, digest, files_digest
from spinbook.build.notebook import notebook_json
from spinbook.build.reading import surroundings
from spinbook.chapter.read import Surroundings, read_chapter
from spinbook.course.course import Course
from spinbook.problem import Problem, Severity
from spinbook.written import write_if_changed


@dataclass(frozen=True)
class Built:
    """What came of one chapter. `notebook` exists unless an error stopped it and it was never built before."""

    chapter: Path
    notebook: Path
    problems: tuple[Problem, ...]
    fresh: bool
    """False where the chapter was not read again, because nothing that it depends on has changed."""

    @property
    def failed(self) -> bool:
        """Whether an error stopped it; what was built before is still there."""
        return any(problem.is_error for problem in self.problems)


def build_notebooks(course: Course) -> Iterator[Built]:
    """Build `build/notebooks/CHAPTER.ipynb` for each chapter, in the course's order.

    A chapter with an error leaves the notebook of its last good build as it was. Notebooks of chapters that the course
    no longer lists are removed.
    """
    folder = course.build_folder / "notebooks"
    record = course.build_folder / ".cache" / "notebooks.json"
    before = _read_record(record)
    known = surroundings(course)
    common = digest(code_digest("chapter", "build", "course", "interfaces"), repr(course), repr(_sorted(known)))
    parts = ("exercises", "solutions")
    exercise_files = files_digest(
        (file for part in parts for file in (course.root / part).rglob("*") if file.is_file()), course.root
    )
    after: dict[str, Any] = {}
    for chapter in course.chapters:
        notebook = folder / f"{chapter.stem}.ipynb"
        key = digest(common, exercise_files, files_digest([course.root / chapter], course.root))
        entry = before.get(chapter.as_posix())
        if entry and entry["key"] == key and notebook.exists():
            built = Built(chapter, notebook, tuple(_problem(p) for p in entry["problems"]), fresh=False)
        else:
            built = _build(course, chapter, notebook, known)
        if not built.failed:
            after[chapter.as_posix()] = {"key": key, "problems": [_plain(problem) for problem in built.problems]}
        yield built
    for gone in set(before) - {chapter.as_posix() for chapter in course.chapters}:
        (folder / f"{Path(gone).stem}.ipynb").unlink(missing_ok=True)
        (course.build_folder / "executed" / f"{Path(gone).stem}.ipynb").unlink(missing_ok=True)
    write_if_changed(record, json.dumps(after, indent=1, sort_keys=True) + "\n")


def _build(course: Course, chapter: Path, notebook: Path, known: Surroundings) -> Built:
    reading = read_chapter(course.root, chapter, known)
    problems = list(reading.problems)
    if reading.chapter is not None:
        try:
            write_if_changed(notebook, notebook_json(reading.chapter, course))
        except ExerciseError as error:
            problems.append(Problem(chapter, None, str(error), "Mend the exercise, or take it out of the chapter."))
    return Built(chapter, notebook, tuple(problems), fresh=True)


def _sorted(known: Surroundings) -> tuple[str, list[str], list[str], list[str]]:
    return known.package, sorted(known.modules), sorted(known.exercises), sorted(known.interfaces)


def _read_record(file: Path) -> Mapping[str, Any]:
    try:
        record = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return record if isinstance(record, dict) else {}


def _plain(problem: Problem) -> dict[str, Any]:
    return {
        "file": problem.file.as_posix(),
        "line": problem.line,
        "found": problem.found,
        "mend": problem.mend,
        "severity": problem.severity.value,
    }


def _problem(plain: Mapping[str, Any]) -> Problem:
    return Problem(Path(plain["file"]), plain["line"], plain["found"], plain["mend"], Severity(plain["severity"]))
