"""Builds the site of a course: read, stage, let Sphinx make the pages, publish."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from groundwork.files import write_if_changed
from groundwork.problem import Problem
from spinbook.browser.files import pyodide_folder
from spinbook.build.digest import code_digest, digest, files_digest, versions
from spinbook.course.course import FILE, Course
from spinbook.site import page as names
from spinbook.site.page import repository_of


@dataclass(frozen=True)
class Site:
    """What came of building a site. `folder` holds it; `pages` counts all, `made` names those made again."""

    folder: Path
    pages: int
    made: tuple[str, ...]
    problems: tuple[Problem, ...]
    seconds: float
    fresh: bool
    """False where nothing that the site depends on has changed since it was built."""


#: What Spinbook's own code makes of a course, down to the outputs of its notebooks.
_CODE = (
    "site",
    "browser",
    "chapter",
    "build",
    "chapters.py",
    "course",
    "kernel",
    "ros2",
    "turtlesim",
    "package",
    "graph",
    "animation.py",
    "interfaces",
)


def unchanged_site(course: Course, *, as_it_ran: bool) -> Site | None:
    """The site as it was built before, if nothing that it depends on has changed since, else None."""
    before = _read(_record(course))
    folder = course.build_folder / "site"
    if before.get("key") != _key(course, as_it_ran=as_it_ran) or not (folder / f"{names.HOME}.html").exists():
        return None
    return Site(folder, int(before["pages"]), (), (), 0.0, fresh=False)


def build_site(course: Course, on_page: Callable[[str], None], *, as_it_ran: bool) -> Site:
    """Build `build/site` from the chapters, the executed notebooks and the exercises; `on_page` hears of each page.

    `as_it_ran` says that the outputs may be older than the chapters. Raises SpinbookError with what an author has to
    fix; the site of the last good build then stays as it was.
    """
    started = time.monotonic()
    record, folder = _record(course), course.build_folder / "site"
    before, key = _read(record), _key(course, as_it_ran=as_it_ran)
    # Sphinx takes a second to import: only where it is needed.
    from spinbook.site.contents import read_contents
    from spinbook.site.sphinx_build import prove_nothing_leaks, publish, run_sphinx, stage

    code = code_digest("site")
    cache = course.build_folder / ".cache" / "site"
    if before.get("code") != code:
        shutil.rmtree(cache, ignore_errors=True)
    contents = read_contents(course)
    prove_nothing_leaks(course, contents)
    source = course.build_folder / "site-source"
    stage(contents, source)
    made: list[str] = []

    def heard(page: str) -> None:
        made.append(page)
        on_page(page)

    html, problems = run_sphinx(contents, source, cache, course, heard)
    pages = [*(page.name for page in contents.pages), names.SEARCH]
    publish(html, pages, contents.files, folder)
    _write_branch(contents.branch, course.build_folder / "launch")
    write_if_changed(record, json.dumps({"key": key, "code": code, "pages": len(pages)}))
    problems = [*contents.problems, *problems]
    return Site(folder, len(pages), tuple(made), tuple(problems), time.monotonic() - started, fresh=True)


def _record(course: Course) -> Path:
    return course.build_folder / ".cache" / "site" / "site.json"


def _key(course: Course, *, as_it_ran: bool) -> str:
    """All that the site depends on."""
    inputs = [course.root / FILE, *(course.root / chapter for chapter in course.chapters)]
    inputs += [course.root / file for file in _shown(course)]
    inputs += [course.root / course.glossary] if course.glossary else []
    for part in ("exercises", "solutions", "interfaces"):
        inputs += [file for file in (course.root / part).rglob("*") if file.is_file() and file.suffix != ".pyc"]
    for made in ("executed", "notebooks"):
        inputs += (course.build_folder / made).glob("*.*")
    repository = repository_of(course.root, course.repository)
    known = (repository.url, repository.commit, repository.date, str(pyodide_folder()))
    return digest(files_digest(inputs, course.root), code_digest(*_CODE), versions(), *known, str(as_it_ran))


def _shown(course: Course) -> list[str]:
    """The files that the chapters include or show, as they were when their notebooks were built."""
    record = _read(course.build_folder / ".cache" / "notebooks.json")
    return sorted({file for entry in record.values() for file in entry.get("uses", [])})


def _read(record: Path) -> dict[str, Any]:
    try:
        found = json.loads(record.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _write_branch(files: dict[str, str], folder: Path) -> None:
    for path, text in files.items():
        write_if_changed(folder / path, text)
    for file in folder.rglob("*"):
        if file.is_file() and file.relative_to(folder).as_posix() not in files:
            file.unlink()
