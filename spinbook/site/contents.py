"""Collects everything to publish from the course and its executed notebooks, before anything is written."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
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
from spinbook.problem import SpinbookError, refuse_errors
from spinbook.site import page as names
from spinbook.site.chapter_page import ExecutedNotebook, as_text, chapter_notebook, stills, wrong_cells
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
    """Read everything that the site shows. Raises AuthorError if a chapter or an exercise can't be shown."""
    chapters = _chapters(course)
    exercises = _exercises(course, chapters)
    repository = repository_of(course.root, course.repository)
    links = Links(_pages_of_files(course, exercises), repository, anchors=_anchors(course))
    return _Collector(course, chapters, exercises, repository, links).collected()


def _chapters(course: Course) -> list[Chapter]:
    readings = list(read_all(course))
    refuse_errors(problem for reading in readings for problem in reading.problems)
    return [reading.chapter for reading in readings if reading.chapter is not None]


def _exercises(course: Course, chapters: list[Chapter]) -> dict[str, Exercise]:
    exercises: dict[str, Exercise] = {}
    for file, cell in ((chapter.file, cell) for chapter in chapters for cell in chapter.exercises):
        name = cell.name or ""
        try:
            exercises[name] = load(course.root / "exercises" / name)
        except ExerciseError as error:
            fix = "Fix the exercise, or remove it from the chapter."
            raise SpinbookError(Problem(file, cell.line, str(error), fix)) from None
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


def _ran(course: Course, chapter: Chapter) -> ExecutedNotebook:
    try:
        return ExecutedNotebook.read(course.build_folder / "executed" / f"{chapter.name}.ipynb")
    except (OSError, ValueError, KeyError):
        if not course.is_run(chapter.file):
            return ExecutedNotebook({})
        problem = "it has not run yet, so there are no outputs to show."
        raise SpinbookError(Problem(chapter.file, None, problem, "Run it: spinbook build --execute")) from None


@dataclass
class _Collector:
    """Collects the pages and files of a site, in the order of the chapters."""

    course: Course
    chapters: list[Chapter]
    exercises: Mapping[str, Exercise]
    repository: Repository
    links: Links
    contents: SiteContents = field(default_factory=SiteContents)
    drawings: _Drawings = field(default_factory=_Drawings)

    def collected(self) -> SiteContents:
        """Return the whole site."""
        contents = self.contents
        self._draw()
        self._read_terms()
        contents.pages.append(self._home())
        for chapter in self.chapters:
            contents.pages.append(self._chapter(chapter))
            for cell in chapter.exercises:
                if names.exercise_page(cell.name or "") not in contents.origins:
                    contents.pages.append(self._exercise(self.exercises[cell.name or ""], chapter))
        contents.pages += self._closing_pages()
        copies = {name: public_parts([exercise]) for name, exercise in self.exercises.items()}
        contents.copies |= {name: content for files in copies.values() for name, content in files.items()}
        self._add_notebooks(copies)
        for code, picture in self.drawings.pictures.items():
            contents.files |= drawing_files(code, picture) if picture else {}
        contents.pictures |= self.links.pictures
        contents.files |= self.links.pictures
        contents.files[SCRIPT] = script()
        if can_run():
            contents.files |= run_files(contents.copies)
        contents.files |= address_files(self.course.site, self.course.title, contents.pages)
        return contents

    def _draw(self) -> None:
        texts = [cell.source for chapter in self.chapters for cell in chapter.cells]
        for text in [*texts, *(exercise.task for exercise in self.exercises.values())]:
            rich(text, self.links, "", "", self.drawings.note)
        try:
            cache = self.course.build_folder / ".cache" / "drawings"
            self.drawings.pictures = draw(list(self.drawings.codes), cache)
        except DrawingError as error:
            problem = f"mermaid drawings are shown as text, because {error}."
            fix = "Everything else is built. Fix this, then build the site again."
            self.contents.problems.append(Problem(self.course.chapters[0], None, problem, fix, Severity.WARNING))

    def _chapter(self, chapter: Chapter) -> Page:
        name, contents = names.chapter_page(chapter.name), self.contents
        ran, graph = _ran(self.course, chapter), node_graph_of(self.course, chapter)
        folder = chapter.file.parent.as_posix()
        prose = {
            cell.id: rich(cell.source, self.links, folder, "chapters", self.drawings.html, chapter.references)
            for cell in chapter.cells
            if cell.kind is CellKind.PROSE
        }
        notebook = chapter_notebook(
            chapter,
            ran,
            prose,
            self.exercises,
            self.repository,
            self._downloads(chapter),
            node_graph_section(graph) if graph else "",
        )
        contents.files |= stills(chapter, ran)
        opening = chapter_opening(chapter, ran)
        contents.files |= opening.files if opening else {}
        contents.origins[name] = chapter.file
        contents.lines[name] = [cell["metadata"]["spinbook"]["line"] for cell in notebook["cells"]]
        contents.taught += [cell.source for cell in chapter.nodes]
        about = {
            "facts": chapter_facts(chapter),
            "opening": opening.about if opening else {},
            "week": chapter.week,
            "minutes": section_minutes(chapter),
            "errors": wrong_cells(chapter, ran),
        }
        text, source = as_text(notebook), self.repository.link(chapter.file, 1)
        summary = chapter.summary
        return Page(name, chapter.title, "chapter", ".ipynb", text, source, chapter.name, summary, about, can_run())

    def _downloads(self, chapter: Chapter) -> dict[str, str]:
        """Add the programs of a chapter's nodes to the site; return cell -> file. Programs may share a file name."""
        paths: dict[str, str] = {}
        for cell in (cell for cell in chapter.cells if cell.kind is CellKind.NODE):
            code = cell.whole.rstrip("\n") + "\n"
            path = f"{DOWNLOADS}/{cell.module}"
            if self.contents.files.get(path, code) != code:
                path = f"{DOWNLOADS}/{chapter.name}/{cell.id}/{cell.module}"
            self.contents.files[path] = code
            paths[cell.id] = path
        return paths

    def _exercise(self, exercise: Exercise, chapter: Chapter) -> Page:
        name = names.exercise_page(exercise.name)
        folder = f"exercises/{exercise.name}"
        task = rich(exercise.task, self.links, folder, "exercises", self.drawings.html)
        begin = starter(exercise.solution_file.read_text(encoding="utf-8")) if exercise.solution_file else ""
        checks = public_checks(exercise.folder / "checks.py")
        if begin:
            self.contents.files[f"{DOWNLOADS}/{exercise.file_name}"] = begin
        self.contents.origins[name] = Path(folder, "task.md")
        text = exercise_markdown(exercise, task, begin, checks, f"../{DOWNLOADS}/{exercise.file_name}")
        about = {
            "points": f"{exercise.points:g}",
            "file": exercise.file_name,
            "chapter": {"title": chapter.title, "page": names.chapter_page(chapter.name)},
        }
        notebook = names.exercise_notebook(exercise.name)
        source = self.repository.link(Path(folder, "task.md"), 1)
        summary = f"An exercise of the chapter {chapter.title}, worth {exercise.points:g} points."
        return Page(name, exercise.title, "exercise", ".md", text, source, notebook, summary, about, can_run())

    def _read_terms(self) -> None:
        glossary = self.course.glossary
        if glossary is None:
            return
        try:
            self.contents.terms = terms_of((self.course.root / glossary).read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError) as error:
            problem = f"the glossary can't be read: {error}."
            raise SpinbookError(Problem(glossary, None, problem, "See `glossary` in course.toml.")) from None
        self.contents.origins[names.GLOSSARY] = glossary

    def _closing_pages(self) -> Iterator[Page]:
        course, first = self.course, self.chapters[0].name
        if course.glossary is not None:
            text = (course.root / course.glossary).read_text(encoding="utf-8")
            links = Links(_pages_of_files(course, {}), self.repository, self.contents.pictures)
            text = rich(text, links, course.glossary.parent.as_posix(), "", lambda code: "")
            source = self.repository.link(course.glossary, 1)
            summary = "The words of the course, each explained in a sentence or two."
            yield Page(names.GLOSSARY, "Glossary", "glossary", ".md", text, source, first, summary)
        middleware = os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
        text = about_markdown(course, self.repository, middleware)
        source = self.repository.link(Path("course.toml"))
        summary = "What the course was built with, and how to run it yourself."
        yield Page(names.ABOUT, "About this course", "about", ".md", text, source, first, summary)

    def _home(self) -> Page:
        runs = [(chapter, _ran(self.course, chapter)) for chapter in self.chapters]
        graphs = [node_graph_of(self.course, chapter) for chapter in self.chapters]
        pictures = home_pictures(runs)
        self.contents.files |= {path: data for picture in pictures for path, data in picture.files.items()}
        about = {
            "chapters": home_chapters(runs, self.exercises),
            "robot": home_robot(runs),
            "graph": next((node_graph_excerpt(graph) for graph in graphs if graph), ""),
            "drawing": home_drawing(self.drawings.pictures),
            "pictures": [picture.about for picture in pictures],
        }
        title, first = self.course.title, self.chapters[0].name
        source = self.repository.link(Path("course.toml"))
        return Page(names.HOME, title, "home", ".md", f"# {title}\n", source, first, title, about)

    def _add_notebooks(self, copies: Mapping[str, Mapping[str, bytes]]) -> None:
        """Add the notebooks to download and to open elsewhere: they install what they need, and hold their exercises.

        `copies` are the files that a check needs, by exercise and path.
        """
        spinbook = requirement(self.repository, (cell.source for chapter in self.chapters for cell in chapter.cells))
        wheels = interface_wheels(self.course, self.contents.copies.values())
        written: list[str] = []

        def add(name: str, notebook: Mapping[str, Any], files: Mapping[str, bytes]) -> None:
            _add_notebook(name, notebook, spinbook, _with_wheels(files, notebook, wheels), self.contents)
            written.append(name)

        for chapter in self.chapters:
            file = self.course.build_folder / "notebooks" / f"{chapter.name}.ipynb"
            notebook = json.loads(file.read_text(encoding="utf-8"))
            held = [(cell, cell.name or "") for cell in chapter.exercises]
            add(chapter.name, notebook, {path: data for _, name in held for path, data in copies[name].items()})
            for cell, name in held:
                add(names.exercise_notebook(name), _only_exercise(notebook, cell.id), copies[name])
        self.contents.branch |= branch_files(written, spinbook, self.course.title)
        for name in written:
            services = openers(self.repository, name)
            self.contents.openers[name] = [asdict(service) for service in services]


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
