"""Makes the notebook for a chapter's page: the chapter's prose and the outputs of its run. Sphinx renders it."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from grader.exercise.exercise import Exercise
from spinbook.build.failures import node_errors
from spinbook.chapter.chapter import Chapter, ChapterCell
from spinbook.chapter.classify import CellKind
from spinbook.kernel.node_errors import ERROR
from spinbook.site.drawings import still_of
from spinbook.site.page import Repository, exercise_page
from spinbook.site.repetition import Repetition, repetitions
from spinbook.site.robots import is_robot, robot_html, robot_still


@dataclass(frozen=True)
class ExecutedNotebook:
    """An executed notebook: its code cells by id."""

    cells: Mapping[str, Mapping[str, Any]]

    @staticmethod
    def read(file: Path) -> ExecutedNotebook:
        """Read the notebook at `file`. Raises OSError or ValueError if it can't be read."""
        notebook = json.loads(file.read_text(encoding="utf-8"))
        return ExecutedNotebook({cell["id"]: cell for cell in notebook["cells"] if cell["cell_type"] == "code"})

    def outputs(self, cell_id: str) -> list[dict[str, Any]]:
        """Return the outputs of a cell; none if it has not run."""
        return list(self.cells.get(cell_id, {}).get("outputs", []))

    def went_wrong(self, cell: ChapterCell) -> bool:
        """Return whether a cell failed, or reports an error of a node, and its author does not expect it."""
        outputs = self.outputs(cell.id)
        failed = not cell.raises and any(output["output_type"] == "error" for output in outputs)
        return failed or any(not about["meant"] for about in node_errors({"outputs": outputs}))


def wrong_cells(chapter: Chapter, ran: ExecutedNotebook) -> list[str]:
    """Return the anchors of the outputs that show that something went wrong."""
    return [_anchor(cell) for cell in chapter.cells if ran.went_wrong(cell)]


def _anchor(cell: ChapterCell) -> str:
    return f"wrong-{cell.id}"


def chapter_notebook(
    chapter: Chapter,
    ran: ExecutedNotebook,
    prose: Mapping[str, str],
    exercises: Mapping[str, Exercise],
    repository: Repository,
    downloads: Mapping[str, str],
    graph: str,
) -> dict[str, Any]:
    """Return the page's notebook. `prose` is the text of each prose cell by id, as returned by `rich`.

    `downloads` are the files of nodes' programs by cell. `graph` is the Markdown of the last section, which shows the
    nodes that ran; "" for none.
    """
    cells: list[dict[str, Any]] = []
    repeated = repetitions(chapter.cells)
    above: dict[str, int] = {}
    for cell in chapter.cells:
        if cell.kind is CellKind.NODE:
            above[cell.module] = cell.before.count("\n")
        if cell.kind is CellKind.PROSE:
            cells.append(_prose(cell, prose[cell.id]))
        elif cell.kind is CellKind.EXERCISE:
            cells.append(_prose(cell, _card(exercises[cell.name or ""])))
        else:
            code = _code(cell, ran, repository.link(chapter.file, cell.line), downloads.get(cell.id, ""))
            code["metadata"]["spinbook"]["repeats"] = asdict(repeated.get(cell.id, Repetition()))
            code["outputs"] = [_numbered(output, above) for output in code["outputs"]]
            cells.append(code)
    if graph:
        cells.append({**_prose(chapter.cells[-1], graph), "id": "nodes-as-seen"})
    return {
        "nbformat": 4,
        "nbformat_minor": 5,
        "metadata": {
            "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
            "language_info": {"name": "python", "pygments_lexer": "ipython3"},
        },
        "cells": cells,
    }


def _prose(cell: ChapterCell, text: str) -> dict[str, Any]:
    return {"cell_type": "markdown", "id": cell.id, "metadata": {"spinbook": {"line": cell.line}}, "source": text}


def _card(exercise: Exercise) -> str:
    """Return what a chapter's page says about an exercise, whose task is on a page of its own."""
    target = f"../{exercise_page(exercise.name)}.html"
    return (
        f'<div class="exercise-card"><p class="exercise-card-kind">Exercise · {exercise.points:g} points</p>'
        f'<p><a href="{target}">{exercise.title}</a></p>'
        "<p>The task, the interface and a starter to download are on the exercise's own page.</p></div>"
    )


def _code(cell: ChapterCell, ran: ExecutedNotebook, source_link: str, download: str) -> dict[str, Any]:
    shown = ran.outputs(cell.id)
    outputs = [_published(output) for output in shown]
    stills = [still_of(output) for output in shown if is_picture(output)]
    about: dict[str, Any] = {
        "kind": cell.kind.value,
        "line": cell.line,
        "source": source_link,
        "alts": [alternative(output, cell) for output in outputs if is_picture(output)],
        "stills": [still.path if still else "" for still in stills],
        "fails": cell.raises,
        "wrong": _anchor(cell) if ran.went_wrong(cell) else "",
        "run": _run(cell),
    }
    if cell.kind is CellKind.NODE:
        about |= {"file": cell.module, "download": download, "after": _after(cell)}
    elif cell.kind is CellKind.PART and cell.runs_in_kernel:
        about["runs_as"] = CellKind.SNIPPET.value
    elif cell.kind is CellKind.INTERFACE:
        about["interface"] = cell.name
    elif cell.kind is CellKind.FILE:
        about["package_file"] = cell.name
    return {
        "cell_type": "code",
        "id": cell.id,
        "metadata": {"spinbook": about, "tags": list(cell.tags)},
        "source": cell.shown.rstrip("\n"),
        "outputs": outputs,
        "execution_count": None,
    }


def _after(cell: ChapterCell) -> str:
    """Return what a node that is shown in pieces runs with, in words."""
    names = [*cell.after] or (["the usual imports"] if cell.before else [])
    return f"runs with {', '.join(names)}" if names else ""


def _run(cell: ChapterCell) -> dict[str, Any]:
    """Return what a page needs to run a cell: code that completes it, names for `ros2 run`, how long to show output."""
    how = ["--main"] if cell.runs_main else ["--class", *cell.spin_classes] if cell.spin_classes else []
    names = [f"{package}/{executable}" for package, executable in cell.executables]
    before = cell.before if cell.kind is CellKind.NODE else ""
    about: dict[str, Any] = {"before": before, "start": how, "executables": names}
    about |= {"seconds": cell.seconds, "until": cell.until, "raises": cell.raises, "replaces": cell.replaces}
    return {key: value for key, value in about.items() if value}


def _published(output: dict[str, Any]) -> dict[str, Any]:
    """Return an output for the page: without formats that a page can't show."""
    if "data" not in output:
        return output
    if is_robot(output):
        return {**output, "data": {"text/html": robot_html(output, "../")}, "metadata": {}}
    data = {kind: content for kind, content in output["data"].items() if kind in _SHOWN}
    if "image/svg+xml" in data:
        data.pop("image/png", None)
    return {**output, "data": data}


#: A line of a node's cell: in a traceback with its path, in a report without.
_LINE = re.compile(r'\b(?P<file>\w+\.py)(?P<quote>"?), line (?P<line>\d+)\b(?! above)')


def _numbered(output: dict[str, Any], above: Mapping[str, int]) -> dict[str, Any]:
    """Return an output with lines counted as in the page's editor, in which `%%node` is no line.

    `above` is how many lines complete each node, by its file: the editor counts those, too.
    """

    def in_page(place: re.Match[str]) -> str:
        line = int(place["line"]) + above.get(place["file"], 1) - 1
        return f"{place['file']}{place['quote']}, line {max(line, 1)}"

    if "text" in output:
        return {**output, "text": _LINE.sub(in_page, "".join(output["text"]))}
    if ERROR in output.get("metadata", {}):
        plain = _LINE.sub(in_page, "".join(output["data"]["text/plain"]))
        return {**output, "data": {**output["data"], "text/plain": plain}}
    return output


_SHOWN = ("image/svg+xml", "image/png", "text/plain")


def is_picture(output: Mapping[str, Any]) -> bool:
    """Return whether an output has a picture, other than a robot."""
    return not is_robot(output) and any(kind.startswith("image/") for kind in output.get("data", {}))


def alternative(output: Mapping[str, Any], cell: ChapterCell) -> str:
    """Return a picture's alternative text: its own, otherwise its plain text, otherwise the code that drew it."""
    for about in output.get("metadata", {}).values():
        if isinstance(about, dict) and about.get("alt"):
            return str(about["alt"])
    plain = "".join(output["data"].get("text/plain", ""))
    if plain and not plain.startswith("<"):
        return plain
    return f"What {cell.source.strip().splitlines()[0]} draws"


def stills(chapter: Chapter, ran: ExecutedNotebook) -> dict[str, bytes]:
    """Return still versions of the chapter's moving pictures: path in the site -> SVG or WebP."""
    outputs = [output for cell in chapter.cells for output in ran.outputs(cell.id)]
    pictures = [still for still in map(still_of, outputs) if still]
    return {still.path: still.data for still in pictures} | dict(map(robot_still, filter(is_robot, outputs)))


def as_text(notebook: Mapping[str, Any]) -> str:
    """Return the notebook as the text of a file."""
    return json.dumps(notebook, ensure_ascii=False, indent=1, sort_keys=True) + "\n"
