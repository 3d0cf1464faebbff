"""Builds the site of a course: reads it, stages the pages, runs Sphinx on them, and publishes the result."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from groundwork.files import json_object, write_folder, write_if_changed
from groundwork.problem import Problem
from spinbook.browser.files import pyodide_folder
from spinbook.build.digest import code_digest, digest, files_digest, versions
from spinbook.course.course import FILE, Course
from spinbook.site import page as names
from spinbook.site.page import repository_of


@dataclass(frozen=True)
class Site:
    """The result of building a site. `pages` is the number of pages in `folder`; `made` names the rebuilt ones."""

    folder: Path
    pages: int
    made: tuple[str, ...]
    problems: tuple[Problem, ...]
    seconds: float
    fresh: bool
    """False if nothing that the site depends on has changed since it was built."""


#: The code of Spinbook that affects a site, including the outputs of its notebooks.
_CODE = ("site", "browser", "chapter", "build", "chapters.py", "course", "kernel", "package", "graph", "interfaces")


def unchanged_site(course: Course, *, as_it_ran: bool) -> Site | None:
    """Return the site as it was built before; None if something that it depends on has changed since."""
    before = json_object(_record(course))
    folder = course.build_folder / "site"
    if before.get("key") != _key(course, as_it_ran=as_it_ran) or not (folder / f"{names.HOME}.html").exists():
        return None
    return Site(folder, int(before["pages"]), (), (), 0.0, fresh=False)


def build_site(course: Course, on_page: Callable[[str], None], *, as_it_ran: bool) -> Site:
    """Build `build/site` from the chapters, the executed notebooks and the exercises; `on_page` gets each page's name.

    `as_it_ran` says that the outputs may be older than the chapters. Raises AuthorError with what an author has to
    fix; the site of the last successful build is then unchanged.
    """
    started = time.monotonic()
    record, folder = _record(course), course.build_folder / "site"
    before, key = json_object(record), _key(course, as_it_ran=as_it_ran)
    # Sphinx takes a second to import, so an unchanged site does without it.
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

    def note_page(page: str) -> None:
        made.append(page)
        on_page(page)

    html, problems = run_sphinx(contents, source, cache, course, note_page)
    pages = [*(page.name for page in contents.pages), *names.own_pages(course.site)]
    publish(html, pages, contents.files, folder, course.site)
    write_folder(course.build_folder / "launch", contents.branch)
    write_if_changed(record, json.dumps({"key": key, "code": code, "pages": len(pages)}))
    problems = [*contents.problems, *problems]
    return Site(folder, len(pages), tuple(made), tuple(problems), time.monotonic() - started, fresh=True)


def _record(course: Course) -> Path:
    return course.build_folder / ".cache" / "site" / "site.json"


def _key(course: Course, *, as_it_ran: bool) -> str:
    """Return a digest of everything that the site depends on."""
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
    """Return the files that the chapters included or showed when their notebooks were built."""
    record = json_object(course.build_folder / ".cache" / "notebooks.json")
    return sorted({file for entry in record.values() for file in entry.get("uses", [])})
