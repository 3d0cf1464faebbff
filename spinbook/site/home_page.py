"""What the home page shows: the course's own pictures and words, as its nodes made them."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from PIL import Image
from pygments import highlight
from pygments.formatters.html import HtmlFormatter

from grader.exercise import Exercise
from spinbook.build.digest import digest
from spinbook.chapter.chapter import Cell, CellKind, Chapter
from spinbook.site.chapter_page import Ran, alternative, is_picture
from spinbook.site.drawing import drawing_html
from spinbook.site.log_lexer import LogLexer
from spinbook.site.mermaid import Picture
from spinbook.site.names import chapter_page, exercise_page
from spinbook.site.picture import FOLDER, smaller, still_of

_LOG_LINES = 6


@dataclass(frozen=True)
class Shown:
    """A picture of the home page: the files that it needs, path -> content, and what the theme needs to know."""

    files: dict[str, bytes]
    about: dict[str, Any]


def home_chapters(chapters: list[Chapter], exercises: Mapping[str, Exercise]) -> list[dict[str, Any]]:
    """The chapters with their exercises, for the list on the home page."""
    return [
        {
            "title": chapter.title,
            "page": chapter_page(chapter.name),
            "summary": chapter.summary,
            "nodes": sum(1 for _ in chapter.nodes),
            "exercises": [
                {"title": exercises[cell.name].title, "page": exercise_page(cell.name)}
                for cell in chapter.cells
                if cell.kind is CellKind.EXERCISE and cell.name
            ],
        }
        for chapter in chapters
    ]


def home_drawing(drawings: Mapping[str, Picture | None]) -> str:
    """The course's first drawing that could be drawn, as HTML; "" where there is none."""
    return next((drawing_html(code, picture, "") for code, picture in drawings.items() if picture), "")


def home_pictures(runs: list[tuple[Chapter, Ran]]) -> list[Shown]:
    """The richest plot and the last turtle that the chapters' nodes drew, where there are some."""
    pictures = [(chapter, cell, output) for chapter, ran in runs for cell, output in _pictures(chapter, ran)]
    plots = [found for found in pictures if "samples" in alternative(found[2], found[1])]
    turtles = [found for found in pictures if "turtle" in alternative(found[2], found[1]).lower()]
    chosen = []
    if plots:
        chosen.append(
            (max(plots, key=lambda found: len(alternative(found[2], found[1]))), "What a topic carried, as it came")
        )
    if turtles:
        chosen.append((turtles[-1], "A turtle, driven by a node"))
    return [_shown(*found, caption) for found, caption in chosen]


def home_log(runs: list[tuple[Chapter, Ran]]) -> dict[str, str]:
    """What the last node with something to warn of printed, and where; {} where no node has printed anything."""
    best: tuple[bool, dict[str, str]] = (False, {})
    for chapter, ran in runs:
        for cell in chapter.nodes:
            text = "".join("".join(o.get("text", "")) for o in ran.outputs(cell.id) if o["output_type"] == "stream")
            lines = [line for line in text.splitlines() if line.startswith("[")][:_LOG_LINES]
            warns = any("[WARN]" in line for line in lines)
            if lines and not cell.raises and warns >= best[0]:
                page = f"{chapter_page(chapter.name)}.html"
                best = warns, {"html": _coloured("\n".join(lines)), "file": cell.module, "page": page}
    return best[1]


def _coloured(log: str) -> str:
    """A log as HTML, coloured as on the chapters' pages."""
    return str(highlight(log, LogLexer(), HtmlFormatter(nowrap=True)))


def _pictures(chapter: Chapter, ran: Ran) -> Iterator[tuple[Cell, dict[str, Any]]]:
    for cell in chapter.cells:
        for output in ran.outputs(cell.id):
            if is_picture(output):
                yield cell, output


def _shown(chapter: Chapter, cell: Cell, output: Mapping[str, Any], caption: str) -> Shown:
    data = output["data"]
    if "image/svg+xml" in data:
        picture, suffix = "".join(data["image/svg+xml"]).encode(), ".svg"
        size: dict[str, int] = {}
    else:
        picture, suffix = base64.b64decode(smaller(data["image/png"])), ".png"
        width, height = Image.open(io.BytesIO(picture)).size
        size = {"width": width, "height": height}
    path = f"{FOLDER}/{digest(picture)[:16]}{suffix}"
    still = still_of(output)
    files = {path: picture} | ({still.path: still.data} if still else {})
    about = {
        "src": path,
        "still": still.path if still else "",
        "alt": alternative(output, cell),
        "caption": caption,
        "page": f"{chapter_page(chapter.name)}.html",
        "chapter": chapter.title,
        **size,
    }
    return Shown(files, about)
