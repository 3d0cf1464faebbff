"""`spinbook import`: turns an existing book into a course, and reports what runs and what does not."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

import click
from jinja2 import Environment, PackageLoader, select_autoescape
from markupsafe import Markup, escape

from groundwork.files import write_if_changed
from groundwork.problem import Problem
from groundwork.words import counted
from spinbook.build.notebooks import BuildResult, build_notebooks
from spinbook.chapter.chapter import Chapter
from spinbook.chapter.classify import CellKind
from spinbook.chapters import read_all
from spinbook.course.course import FILE, Course, read_course
from spinbook.course.obstacles import by_itself, obstacles, ranked
from spinbook.importing.book import Book, read_book
from spinbook.importing.conversion import as_markdown
from spinbook.importing.pages import CONVERTED
from spinbook.problem import SpinbookError

_RUNS = (CellKind.NODE, CellKind.SNIPPET, CellKind.PART, CellKind.SHELL, CellKind.INTERFACE, CellKind.FILE)
_PLACES = 12
_MARKED = re.compile(r"(```[^\n]+|`[^`]*`)")


def report_page(course: Course, rows: Sequence[dict[str, Any]], problems: Sequence[Problem], **counts: int) -> str:
    """Return the page as HTML, in a single file."""
    environment = Environment(loader=PackageLoader("spinbook.importing", "."), autoescape=select_autoescape(["j2"]))
    environment.filters["code"] = _code
    causes = [
        {"words": item.in_words, "places": [one.place for one in item.problems[:_PLACES]], "more": len(item.problems)}
        for item in obstacles(problems)
    ]
    return environment.get_template("report.html.j2").render(
        title=course.title, rows=rows, causes=causes, single=list(by_itself(problems)), places=_PLACES, **counts
    )


def _code(text: str) -> Markup:
    """Return text as HTML, with code between backticks. The opening line of a fence keeps its backticks."""
    parts = _MARKED.split(text)
    code = (Markup("<code>{}</code>").format(p if p.startswith("```") else p.strip("`")) for p in parts[1::2])
    return Markup("").join(piece for pair in zip_longest(map(escape, parts[::2]), code, fillvalue="") for piece in pair)


def _row(chapter: Chapter, course: Course) -> dict[str, Any]:
    counts = {kind: sum(cell.kind is kind for cell in chapter.cells) for kind in _RUNS}
    notebook = course.build_folder / "notebooks" / f"{chapter.name}.ipynb"
    return {
        "title": chapter.title,
        "file": chapter.file.as_posix(),
        "notebook": os.path.relpath(notebook, course.build_folder),
        "runs": sum(counts.values()),
        "nodes": counts[CellKind.NODE],
        "counts": ", ".join(f"{count} {kind.value}" for kind, count in counts.items() if count),
        "static": [fence for fence in chapter.static_fences if fence.sign],
    }


_SHOWN = 6


@click.command(name="import", context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("book", type=click.Path(path_type=Path), default=".")
@click.option("--title", help="The course's title.  [default: the book's]")
@click.option("--package", help="The name of the ROS 2 package for the nodes.  [default: from the title]")
def import_book(book: Path, title: str | None, package: str | None) -> None:
    """Make a course from an existing book, without changing its chapters.

    \b
      spinbook import my-book                  a folder: its table of contents is found
      spinbook import my-book/mkdocs.yml       MkDocs
      spinbook import my-book/docs/_toc.yml    Jupyter Book; also myst.yml, _quarto.yml
      spinbook import my-book/sidebars.js      Docusaurus; also astro.config.mjs, SUMMARY.md, _sidebar.md
      spinbook import my-book/docs/conf.py     Sphinx

    Notebooks and reStructuredText (.ipynb, .rst) become Markdown files next to them.

    Writes course.toml with the chapters in the book's order, builds the notebooks, and writes a page that says
    what runs, what does not, and what to do first: build/import.html. Runs nothing. It never overwrites a course.toml.
    """
    read = read_book(book)
    if (read.root / FILE).exists():
        found = f"{read.root} is already a course."
        raise SpinbookError(Problem(read.root / FILE, None, found, "Go there, and run: spinbook build"))
    originals = [chapter for chapter in read.chapters if chapter.suffix in CONVERTED]
    read = _in_markdown(read)
    text = course_toml(read, title or read.title, package or package_of(title or read.title))
    write_if_changed(read.root / FILE, text)
    course = read_course(read.root)
    order = read.contents.relative_to(read.root).as_posix() if read.contents else "their names"
    click.echo(f"{course.title}: {counted(len(read.chapters), 'chapter')}, in the order of {order}")
    if originals:
        click.echo(f"Converted to Markdown, next to the originals: {', '.join(map(str, originals))}")
    if read.left_out:
        click.echo(f"Left out because they are missing or of another kind: {', '.join(read.left_out)}")
    if read.unlisted:
        click.echo(f"Not listed there, so no chapters: {', '.join(map(str, read.unlisted))}")
    built = list(build_notebooks(course))
    _report(course, built)


def _in_markdown(book: Book) -> Book:
    """Return the book with its notebooks and reStructuredText converted. Raises SpinbookError."""
    files = [as_markdown(book.root / chapter) for chapter in book.chapters if chapter.suffix in CONVERTED]
    if not files:
        return book
    chapters = (chapter.with_suffix(".md") if chapter.suffix in CONVERTED else chapter for chapter in book.chapters)
    return replace(book, chapters=tuple(dict.fromkeys(chapters)))


def course_toml(book: Book, title: str, package: str) -> str:
    """Return the course.toml of a book. JSON's texts are basic strings of TOML, too."""
    quoted = partial(json.dumps, ensure_ascii=False)
    chapters = "".join(f"  {quoted(chapter.as_posix())},\n" for chapter in book.chapters)
    repository = f"repository = {quoted(book.repository)}\n" if book.repository else ""
    return (
        "# The course's title, and the order of its chapters: see docs/writing-chapters.md.\n"
        f"title = {quoted(title)}\n{repository}chapters = [\n{chapters}]\n\n"
        "# The chapters that `spinbook site` runs, besides those that `spinbook build --execute` has run.\n"
        "run = []\n\n"
        "# The ROS 2 package that the chapters' nodes make: `spinbook package`.\n"
        f'[package]\nname = "{package}"\nworkspace = "{package}_ws"\n'
    )


def package_of(title: str) -> str:
    """Return a name for a ROS package from a title."""
    name = re.sub(r"[^a-z0-9]+", "_", title.lower()).strip("_")[:40].strip("_")
    return name if name[:1].isalpha() else f"course_{name}".strip("_")


def _report(course: Course, built: Sequence[BuildResult]) -> None:
    rows = [_row(reading.chapter, course) for reading in read_all(course) if reading.chapter]
    problems = [problem for item in built for problem in item.problems]
    page = course.build_folder / "import.html"
    cells, nodes = (sum(row[key] for row in rows) for key in ("runs", "nodes"))
    static = sum(len(row["static"]) for row in rows)
    write_if_changed(page, report_page(course, rows, problems, cells=cells, nodes=nodes, static=static))
    made = sum(not item.failed for item in built)
    click.echo(f"{made} of {len(built)} chapters built: {cells} cells, {nodes} of them nodes")
    click.echo(f"shown and not run: {counted(static, 'piece')} of code")
    for line in [*(str(problem) for problem in problems if problem.is_error), *ranked(problems)][: _SHOWN + 1]:
        click.echo(line)
    folder = os.path.relpath(course.root)
    go = f"  cd {folder}\n" if folder != "." else ""
    click.echo(
        f"What runs, what does not, and what to do first: {os.path.relpath(page)}\n\nGo on with:\n\n{go}"
        "  spinbook build --execute      run the notebooks, with real nodes\n"
        "  spinbook site                 the website, with what the cells printed"
    )
