"""The page that says what of an imported book runs, what does not, and what to do first."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from jinja2 import Environment, PackageLoader, select_autoescape
from markupsafe import Markup, escape

from spinbook.chapter.chapter import CellKind, Chapter
from spinbook.course.course import Course
from spinbook.course.obstacles import by_itself, obstacles
from spinbook.problem import Problem

_RUNS = (CellKind.NODE, CellKind.SNIPPET, CellKind.PART, CellKind.SHELL, CellKind.INTERFACE, CellKind.FILE)
_PLACES = 12


def report_page(course: Course, chapters: Sequence[Chapter], problems: Sequence[Problem]) -> str:
    """The page as HTML, complete in itself."""
    environment = Environment(loader=PackageLoader("spinbook.importing", "."), autoescape=select_autoescape(["j2"]))
    environment.filters["code"] = _code
    rows = [_row(chapter, course) for chapter in chapters]
    causes = [
        {"words": item.in_words, "blocks": item.blocks, "places": _places(item.problems), "more": len(item.problems)}
        for item in obstacles(problems)
    ]
    single = list(by_itself(problems))
    return environment.get_template("report.html.j2").render(
        title=course.title,
        rows=rows,
        causes=causes,
        single=single,
        places=_PLACES,
        cells=sum(row["runs"] for row in rows),
        static=sum(len(row["static"]) for row in rows),
        nodes=sum(row["nodes"] for row in rows),
        empty=sum(not row["runs"] for row in rows),
    )


def _code(text: str) -> Markup:
    """Text with what is between backticks as code."""
    parts = [escape(part) for part in text.split("`")]
    return Markup("").join(Markup("<code>{}</code>").format(p) if i % 2 else p for i, p in enumerate(parts))


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


def _places(problems: Sequence[Problem]) -> list[str]:
    return [f"{problem.file.as_posix()}:{problem.line}" for problem in problems[:_PLACES]]
