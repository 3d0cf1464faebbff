"""Builds the notebooks of a course, those whose chapters changed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from grader.exercise.exercise import ExerciseError
from groundwork.files import json_object, write_if_changed
from groundwork.problem import Problem
from spinbook.build.digest import code_digest, digest, files_digest
from spinbook.build.notebook import notebook_json
from spinbook.chapter.files import locate
from spinbook.chapter.labels import may_refer
from spinbook.chapter.read import read_chapter
from spinbook.chapter.surroundings import Surroundings
from spinbook.chapters import surroundings
from spinbook.course.course import Course
from spinbook.course.obstacles import ranked, strict


@dataclass(frozen=True)
class BuildResult:
    """The result of one chapter. `notebook` exists unless an error stopped the chapter and it was never built
    before."""

    chapter: Path
    notebook: Path
    problems: tuple[Problem, ...]
    fresh: bool
    """False if the chapter was not read again, because nothing that it depends on has changed."""
    uses: tuple[str, ...] = ()
    """The files of the course that it includes or shows."""

    @property
    def name(self) -> str:
        """The chapter's name."""
        return self.notebook.name.removesuffix(".ipynb")

    @property
    def failed(self) -> bool:
        """Whether an error stopped it; what was built before is still there."""
        return any(problem.is_error for problem in self.problems)


def build_notebooks(course: Course, *, is_strict: bool = False) -> Iterator[BuildResult]:
    """Build `build/notebooks/CHAPTER.ipynb` for each chapter, in the course's order.

    With `is_strict`, code that is shown but not run is an error.

    A chapter with an error leaves the notebook of its last good build as it was. Notebooks of chapters that the course
    no longer lists are removed.
    """
    folder = course.build_folder / "notebooks"
    record = course.build_folder / ".cache" / "notebooks.json"
    before = _read_record(record)
    locate.cache_clear()
    known = surroundings(course)
    code = code_digest("chapter", "chapters.py", "build", "course", "interfaces")
    common = digest(code, repr(course), repr(_sorted(known)), str(is_strict))
    files = (file for part in ("exercises", "solutions") for file in (course.root / part).rglob("*"))
    own = digest(common, files_digest(filter(Path.is_file, files), course.root))
    after: dict[str, Any] = {}
    for chapter in course.chapters:
        notebook = folder / f"{known.names[chapter]}.ipynb"
        entry = before.get(chapter.as_posix())
        key = _key(own, chapter, entry["uses"] if entry else [], course, known)
        if entry and entry["key"] == key and notebook.exists():
            problems = tuple(map(Problem.from_plain, entry["problems"]))
            built = BuildResult(chapter, notebook, problems, False, tuple(entry["uses"]))
        else:
            built = _build(course, chapter, notebook, known, is_strict)
        if not built.failed:
            after[chapter.as_posix()] = {
                "key": _key(own, chapter, built.uses, course, known),
                "notebook": notebook.name,
                "uses": built.uses,
                "problems": [problem.plain for problem in built.problems],
            }
        yield built
    names = {f"{name}.ipynb" for name in known.names.values()}
    for name in {entry["notebook"] for entry in before.values()} - names:
        (folder / name).unlink(missing_ok=True)
        (course.build_folder / "executed" / name).unlink(missing_ok=True)
    write_if_changed(record, json.dumps(after, indent=1, sort_keys=True) + "\n")


def report(console: Console, built: Sequence[BuildResult]) -> None:
    """Print what is wrong in the chapters: one by one, then what keeps many cells from running."""
    problems = [problem for item in built for problem in item.problems]
    for problem in problems:
        if problem.is_error or not problem.group:
            console.print(str(problem), markup=False, style="red" if problem.is_error else None)
    for line in ranked([problem for problem in problems if not problem.is_error]):
        console.print(line, markup=False)


def _build(course: Course, chapter: Path, notebook: Path, known: Surroundings, is_strict: bool) -> BuildResult:
    reading = read_chapter(course.root, chapter, known)
    problems = [strict(problem) for problem in reading.problems] if is_strict else list(reading.problems)
    if reading.chapter is not None and not any(problem.is_error for problem in problems):
        try:
            write_if_changed(notebook, notebook_json(reading.chapter, course))
        except ExerciseError as error:
            problems.append(Problem(chapter, None, str(error), "Fix the exercise, or remove it from the chapter."))
    uses = tuple(file.as_posix() for file in reading.chapter.uses) if reading.chapter else ()
    return BuildResult(chapter, notebook, tuple(problems), fresh=True, uses=uses)


def _key(own: str, chapter: Path, uses: Sequence[str], course: Course, known: Surroundings) -> str:
    """Return what a chapter's notebook depends on: the chapter, all chapters' surroundings, the files that it shows.

    Titles and labels of other chapters count only for a chapter that may refer to them.
    """
    files = [course.root / chapter, *(course.root / file for file in uses)]
    texts = (file.read_bytes().decode(errors="replace") for file in files if file.is_file())
    referred = _named(known) if any(may_refer(text, known.labels) for text in texts) else ""
    return digest(own, files_digest(files, course.root), repr(referred))


def _sorted(known: Surroundings) -> tuple[Any, ...]:
    names = sorted(known.names.items())
    not_compiled = sorted((str(file), line, str(fault)) for (file, line), fault in known.not_compiled.items())
    return (
        known.package,
        sorted(known.modules),
        sorted(known.exercises),
        names,
        sorted(known.interfaces.items()),
        not_compiled,
    )


def _named(known: Surroundings) -> tuple[Any, ...]:
    labels = [(name, str(label)) for name, label in sorted(known.labels.items())]
    return sorted(known.titles.items()), labels


def _read_record(file: Path) -> Mapping[str, Any]:
    record = json_object(file)
    return record if all("uses" in entry for entry in record.values()) else {}
