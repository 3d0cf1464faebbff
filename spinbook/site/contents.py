"""Collects everything to publish from the course and its executed notebooks, before anything is written."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import jupytext
import nbformat

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import load
from grader.exercise.starter import starter
from groundwork.problem import Problem, Severity
from spinbook.browser.files import can_run, public_parts, run_files
from spinbook.chapter.chapter import Chapter
from spinbook.chapter.classify import CellKind
from spinbook.chapter.comments import without_comments
from spinbook.chapter.read import headings_of
from spinbook.chapters import read_all
from spinbook.course.course import Course
from spinbook.handout.wheels import interface_wheels, package_of
from spinbook.problem import SpinbookError
from spinbook.site import page as names
from spinbook.site.chapter_page import ExecutedNotebook, ExerciseCard, as_text, chapter_notebook, stills, wrong_cells
from spinbook.site.drawings import DrawingError, Picture, draw, drawing_files, drawing_html
from spinbook.site.exercise_page import exercise_markdown, public_checks
from spinbook.site.graph_section import node_graph_excerpt, node_graph_of, node_graph_section
from spinbook.site.home_page import (
    about_markdown,
    chapter_opening,
    home_chapters,
    home_drawing,
    home_pictures,
    home_robot,
)
from spinbook.site.minutes import chapter_facts, section_minutes
from spinbook.site.notebooks import branch_files, launch_notebook, openers, requirement
from spinbook.site.page import Page, Repository, address_files, repository_of
from spinbook.site.prose import Links, Term, rich, terms_of
from spinbook.site.robots import SCRIPT, script

DOWNLOADS = "downloads"


@dataclass
class SiteContents:
    """The site before it is built.

    `pages` are in reading order, the home page first. `pictures` are those that the text shows: path in the site ->
    content. `files` go into the site unchanged, `branch` into the branch of notebooks: path -> text. `origins` is the
    author's file for each staged page, and `lines` the first line of each cell of a chapter's page. `taught` is the
    code of the chapters' nodes; `copies` are the students' copies of exercises in the notebooks: path -> content.
    """

    pages: list[Page] = field(default_factory=list)
    files: dict[str, str | bytes] = field(default_factory=dict)
    branch: dict[str, str] = field(default_factory=dict)
    pictures: dict[str, bytes] = field(default_factory=dict)
    openers: dict[str, list[dict[str, str]]] = field(default_factory=dict)
    terms: tuple[Term, ...] = ()
    origins: dict[str, Path] = field(default_factory=dict)
    lines: dict[str, list[int]] = field(default_factory=dict)
    taught: list[str] = field(default_factory=list)
    copies: dict[str, bytes] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)


class _Drawings:
    """The drawings of a course: collected in the first pass over the text, inserted in the second."""

    def __init__(self) -> None:
        self.codes: dict[str, None] = {}
        self.pictures: dict[str, Picture | None] = {}

    def note(self, code: str) -> str:
        self.codes[code] = None
        return ""

    def html(self, code: str) -> str:
        return drawing_html(code, self.pictures.get(code), "../")


def read_contents(course: Course) -> SiteContents:
    """Read everything that the site shows. Raises SpinbookError if a chapter or an exercise can't be shown."""
    chapters = _chapters(course)
    exercises = _exercises(course, chapters)
    repository = repository_of(course.root, course.repository)
    contents = SiteContents()
    links = Links(_pages_of_files(course, exercises), repository, anchors=_anchors(course))
    drawings = _drawn(course, chapters, exercises, links, contents)
    _glossary(course, contents)
    first = chapters[0].name
    contents.pages.append(_home(course, chapters, exercises, repository, drawings, contents))
    for chapter in chapters:
        contents.pages.append(_chapter(course, chapter, exercises, links, drawings, contents))
        for cell in chapter.cells:
            if cell.kind is CellKind.EXERCISE and names.exercise_page(cell.name or "") not in contents.origins:
                page = _exercise(exercises[cell.name or ""], chapter, links, drawings, contents)
                contents.pages.append(page)
    contents.pages += _closing_pages(course, repository, first, contents)
    copies = _copies(exercises)
    contents.copies |= {name: content for files in copies.values() for name, content in files.items()}
    _notebooks(course, chapters, copies, repository, contents)
    for code, picture in drawings.pictures.items():
        if picture is not None:
            contents.files |= drawing_files(code, picture)
    contents.pictures |= links.pictures
    contents.files |= links.pictures
    contents.files[SCRIPT] = script()
    if can_run():
        contents.files |= run_files(contents.copies)
    contents.files |= address_files(course.site, course.title, contents.pages)
    return contents


def _copies(exercises: Mapping[str, Exercise]) -> dict[str, dict[str, bytes]]:
    """Return the files that a check needs, by exercise and path."""
    try:
        return {name: public_parts([exercise]) for name, exercise in exercises.items()}
    except ExerciseError as error:
        raise SpinbookError(error.problem) from None


def _chapters(course: Course) -> list[Chapter]:
    readings = list(read_all(course))
    problems = [problem for reading in readings for problem in reading.problems if problem.is_error]
    if problems:
        raise SpinbookError(*problems)
    return [reading.chapter for reading in readings if reading.chapter is not None]


def _exercises(course: Course, chapters: list[Chapter]) -> dict[str, Exercise]:
    exercises: dict[str, Exercise] = {}
    for chapter in chapters:
        for cell in chapter.cells:
            if cell.kind is CellKind.EXERCISE and cell.name:
                try:
                    exercises[cell.name] = load(course.root / "exercises" / cell.name)
                except ExerciseError as error:
                    fix = "Fix the exercise, or remove it from the chapter."
                    raise SpinbookError(Problem(chapter.file, cell.line, str(error), fix)) from None
    return exercises


def _pages_of_files(course: Course, exercises: Mapping[str, Exercise]) -> dict[str, str]:
    """Return the staged file of each of the course's files that has a page. Sphinx turns it into an address."""
    pages = {file.as_posix(): f"{names.chapter_page(name)}.ipynb" for file, name in course.names.items()}
    pages |= {f"exercises/{name}/task.md": f"{names.exercise_page(name)}.md" for name in exercises}
    if course.glossary:
        pages[course.glossary.as_posix()] = f"{names.GLOSSARY}.md"
    return pages


def _anchors(course: Course) -> dict[tuple[str, str], str]:
    """Return the id of each heading on its page, by file and JupyterLab's id."""
    headings = ((file, heading) for file in course.chapters for heading in headings_of(course.root, file))
    return {(file.as_posix(), heading.anchor): heading.slug for file, heading in headings}


def _drawn(
    course: Course,
    chapters: list[Chapter],
    exercises: Mapping[str, Exercise],
    links: Links,
    contents: SiteContents,
) -> _Drawings:
    drawings = _Drawings()
    for text in [cell.source for c in chapters for cell in c.cells] + [e.task for e in exercises.values()]:
        rich(text, links, "", "", drawings.note)
    try:
        drawings.pictures = draw(list(drawings.codes), course.build_folder / ".cache" / "drawings")
    except DrawingError as error:
        found = f"mermaid drawings are shown as text, because {error}."
        fix = "Everything else is built. Fix this, then build the site again."
        contents.problems.append(Problem(course.chapters[0], None, found, fix, Severity.WARNING))
    return drawings


def _chapter(
    course: Course,
    chapter: Chapter,
    exercises: Mapping[str, Exercise],
    links: Links,
    drawings: _Drawings,
    contents: SiteContents,
) -> Page:
    name = names.chapter_page(chapter.name)
    ran = _ran(course, chapter)
    folder = chapter.file.parent.as_posix()
    prose = {
        cell.id: rich(cell.source, links, folder, "chapters", drawings.html, chapter.references)
        for cell in chapter.cells
        if cell.kind is CellKind.PROSE
    }
    cards = {name: ExerciseCard(name, exercise.title, exercise.points) for name, exercise in exercises.items()}
    downloads = _downloads(chapter, contents)
    notebook = chapter_notebook(chapter, ran, prose, cards, links.repository, downloads, _graph(course, chapter))
    contents.files |= stills(chapter, ran)
    opening = chapter_opening(chapter, ran)
    contents.files |= opening.files if opening else {}
    contents.origins[name] = chapter.file
    contents.lines[name] = [cell["metadata"]["spinbook"]["line"] for cell in notebook["cells"]]
    contents.taught += [cell.source for cell in chapter.nodes]
    source = links.repository.link(chapter.file, 1)
    text = as_text(notebook)
    runs = can_run()
    return Page(
        name,
        chapter.title,
        "chapter",
        ".ipynb",
        text,
        source,
        chapter.name,
        summary=chapter.summary,
        about={
            "facts": chapter_facts(chapter),
            "opening": opening.about if opening else {},
            "week": chapter.week,
            "minutes": section_minutes(chapter),
            "errors": wrong_cells(chapter, ran),
        },
        runs=runs,
    )


def _downloads(chapter: Chapter, contents: SiteContents) -> dict[str, str]:
    """Add the programs of a chapter's nodes to the site; return cell -> file. Programs may share a file name."""
    paths: dict[str, str] = {}
    for cell in (cell for cell in chapter.cells if cell.kind is CellKind.NODE):
        code = cell.whole.rstrip("\n") + "\n"
        path = f"{DOWNLOADS}/{cell.module}"
        if contents.files.get(path, code) != code:
            path = f"{DOWNLOADS}/{chapter.name}/{cell.id}/{cell.module}"
        contents.files[path] = code
        paths[cell.id] = path
    return paths


def _ran(course: Course, chapter: Chapter) -> ExecutedNotebook:
    file = course.build_folder / "executed" / f"{chapter.name}.ipynb"
    try:
        return ExecutedNotebook.read(file)
    except (OSError, ValueError, KeyError):
        if not course.is_run(chapter.file):
            return ExecutedNotebook({})
        found = "it has not run yet, so there are no outputs to show."
        raise SpinbookError(Problem(chapter.file, None, found, "Run it: spinbook build --execute")) from None


def _graph(course: Course, chapter: Chapter) -> str:
    """Return the section with the picture of the nodes that ran with the chapter; "" if there were none."""
    graph = node_graph_of(course, chapter)
    return node_graph_section(graph) if graph else ""


def _exercise(exercise: Exercise, chapter: Chapter, links: Links, drawings: _Drawings, contents: SiteContents) -> Page:
    name = names.exercise_page(exercise.name)
    folder = f"exercises/{exercise.name}"
    task = rich(exercise.task, links, folder, "exercises", drawings.html)
    begin = _starter_of(exercise)
    checks = public_checks(exercise.folder / "checks.py")
    if begin:
        contents.files[f"{DOWNLOADS}/{exercise.file_name}"] = begin
    contents.origins[name] = Path(folder, "task.md")
    text = exercise_markdown(exercise, task, begin, checks, f"../{DOWNLOADS}/{exercise.file_name}")
    about = {
        "points": f"{exercise.points:g}",
        "file": exercise.file_name,
        "chapter": {"title": chapter.title, "page": names.chapter_page(chapter.name)},
    }
    notebook = names.exercise_notebook(exercise.name)
    source = links.repository.link(Path(folder, "task.md"), 1)
    summary = f"An exercise of the chapter {chapter.title}, worth {exercise.points:g} points."
    return Page(name, exercise.title, "exercise", ".md", text, source, notebook, summary, about, can_run())


def _starter_of(exercise: Exercise) -> str:
    return starter(exercise.solution_file.read_text(encoding="utf-8")) if exercise.solution_file else ""


def _glossary(course: Course, contents: SiteContents) -> None:
    if course.glossary is None:
        return
    try:
        text = (course.root / course.glossary).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        found = f"the glossary can't be read: {error}."
        raise SpinbookError(Problem(course.glossary, None, found, "See `glossary` in course.toml.")) from None
    contents.terms = terms_of(text)
    contents.origins[names.GLOSSARY] = course.glossary


def _closing_pages(course: Course, repository: Repository, first: str, contents: SiteContents) -> Iterator[Page]:
    if course.glossary is not None:
        text = (course.root / course.glossary).read_text(encoding="utf-8")
        links = Links(_pages_of_files(course, {}), repository, contents.pictures)
        text = rich(text, links, course.glossary.parent.as_posix(), "", lambda code: "")
        source = repository.link(course.glossary, 1)
        summary = "The words of the course, each explained in a sentence or two."
        yield Page(names.GLOSSARY, "Glossary", "glossary", ".md", text, source, first, summary)
    middleware = os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
    text = about_markdown(course, repository, middleware)
    source = repository.link(Path("course.toml"))
    summary = "What the course was built with, and how to run it yourself."
    yield Page(names.ABOUT, "About this course", "about", ".md", text, source, first, summary)


def _home(
    course: Course,
    chapters: list[Chapter],
    exercises: Mapping[str, Exercise],
    repository: Repository,
    drawings: _Drawings,
    contents: SiteContents,
) -> Page:
    runs = [(chapter, _ran(course, chapter)) for chapter in chapters]
    graphs = [node_graph_of(course, chapter) for chapter in chapters]
    pictures = home_pictures(runs)
    contents.files |= {path: data for picture in pictures for path, data in picture.files.items()}
    about = {
        "chapters": home_chapters(runs, exercises),
        "robot": home_robot(runs),
        "graph": next((node_graph_excerpt(graph) for graph in graphs if graph), ""),
        "drawing": home_drawing(drawings.pictures),
        "pictures": [picture.about for picture in pictures],
    }
    source = repository.link(Path("course.toml"))
    text = f"# {course.title}\n"
    return Page(names.HOME, course.title, "home", ".md", text, source, chapters[0].name, course.title, about)


def _notebooks(
    course: Course,
    chapters: list[Chapter],
    copies: Mapping[str, Mapping[str, bytes]],
    repository: Repository,
    contents: SiteContents,
) -> None:
    """Add the notebooks to download and to open elsewhere. They install what they need and contain their exercises."""
    spinbook = requirement(repository)
    wheels = interface_wheels(course, contents.copies.values())
    written: list[str] = []
    for chapter in chapters:
        file = course.build_folder / "notebooks" / f"{chapter.name}.ipynb"
        notebook = json.loads(file.read_text(encoding="utf-8"))
        held = [cell for cell in chapter.cells if cell.kind is CellKind.EXERCISE and cell.name]
        brought = {path: data for cell in held for path, data in copies[cell.name or ""].items()}
        _add_notebook(chapter.name, notebook, spinbook, _with_wheels(brought, notebook, wheels), contents)
        written.append(chapter.name)
        for cell in held:
            name = names.exercise_notebook(cell.name or "")
            alone = _only_exercise(notebook, cell.id)
            _add_notebook(name, alone, spinbook, _with_wheels(copies[cell.name or ""], alone, wheels), contents)
            written.append(name)
    contents.branch |= branch_files(written, spinbook, course.title)
    for name in written:
        contents.openers[name] = [{"name": o.name, "url": o.url} for o in openers(repository, name)]


def _with_wheels(
    files: Mapping[str, bytes], notebook: Mapping[str, Any], wheels: Mapping[str, bytes]
) -> dict[str, bytes]:
    """Add the wheels of the packages that a notebook, or one of its files, mentions."""
    text = json.dumps(notebook).encode() + b"".join(files.values())
    needed = {f"wheels/{name}": data for name, data in wheels.items() if package_of(name).encode() in text}
    return {**files, **needed}


def _only_exercise(notebook: Mapping[str, Any], cell_id: str) -> dict[str, Any]:
    """Return a chapter's notebook with only its set-up and one exercise: task, starter and check.

    `cell_id` is the id of the exercise's cell in the chapter; the ids of the notebook's cells begin with it.
    """
    ids = {f"{cell_id}-{part}" for part in ("task", "starter", "try", "check")}
    task, *rest = [cell for cell in notebook["cells"] if cell["id"] in ids]
    setup = [cell for cell in notebook["cells"] if cell["id"] == "spinbook-setup"]
    return {**notebook, "cells": [task, *setup, *rest]}


def _add_notebook(
    name: str, notebook: Mapping[str, Any], spinbook: str, exercises: Mapping[str, bytes], contents: SiteContents
) -> None:
    ready = launch_notebook(notebook, spinbook, exercises)
    for cell in ready["cells"]:
        if cell["cell_type"] == "markdown":
            cell["source"] = without_comments(cell["source"])
    contents.branch[f"{name}.ipynb"] = contents.files[f"{DOWNLOADS}/{name}.ipynb"] = as_text(ready)
    script = jupytext.writes(nbformat.from_dict(ready), fmt="py:percent")
    contents.files[f"{DOWNLOADS}/{name}.notebook.py"] = script
