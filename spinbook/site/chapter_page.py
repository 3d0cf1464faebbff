"""Makes the notebook from which Sphinx makes a chapter's page: the chapter's own prose, the outputs of its run."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spinbook.chapter.chapter import Cell, Chapter
from spinbook.chapter.classify import CellKind
from spinbook.course.course import Course
from spinbook.graph.layout import drawings
from spinbook.graph.model import NodeGraph
from spinbook.graph.picture import node_graph_svg, node_graph_svgs
from spinbook.site.drawing import smaller, still_of
from spinbook.site.page import Repository, exercise_page


@dataclass(frozen=True)
class Ran:
    """An executed notebook: its code cells by id."""

    cells: Mapping[str, Mapping[str, Any]]

    @staticmethod
    def read(file: Path) -> Ran:
        """Read the notebook at `file`. Raises OSError or ValueError where it can't be read."""
        notebook = json.loads(file.read_text(encoding="utf-8"))
        return Ran({cell["id"]: cell for cell in notebook["cells"] if cell["cell_type"] == "code"})

    def outputs(self, cell_id: str) -> list[dict[str, Any]]:
        """What a cell showed; nothing, where it has not run."""
        return list(self.cells.get(cell_id, {}).get("outputs", []))


@dataclass(frozen=True)
class ExerciseCard:
    """What a chapter's page says about an exercise, whose task is on a page of its own."""

    name: str
    title: str
    points: float


def chapter_notebook(
    chapter: Chapter,
    ran: Ran,
    prose: Mapping[str, str],
    exercises: Mapping[str, ExerciseCard],
    repository: Repository,
    downloads: Mapping[str, str],
    graph: str = "",
) -> dict[str, Any]:
    """The page's notebook. `prose` holds the text of each prose cell by id, as `rich` made it.

    `downloads` are the files of nodes' programs by cell. `graph` is the Markdown of the section that shows the nodes
    that ran; it is the page's last.
    """
    cells: list[dict[str, Any]] = []
    for cell in chapter.cells:
        if cell.kind is CellKind.PROSE:
            cells.append(_prose(cell, prose[cell.id]))
        elif cell.kind is CellKind.EXERCISE:
            cells.append(_prose(cell, _card(exercises[cell.name or ""])))
        else:
            cells.append(_code(cell, ran, repository.link(chapter.file, cell.line), downloads.get(cell.id, "")))
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


def _prose(cell: Cell, text: str) -> dict[str, Any]:
    return {"cell_type": "markdown", "id": cell.id, "metadata": {"spinbook": {"line": cell.line}}, "source": text}


def _card(exercise: ExerciseCard) -> str:
    target = f"../{exercise_page(exercise.name)}.html"
    return (
        f'<div class="exercise-card"><p class="exercise-card-kind">Exercise · {exercise.points:g} points</p>'
        f'<p><a href="{target}">{exercise.title}</a></p>'
        "<p>The task, the interface, and a starter to download are on a page of their own.</p></div>"
    )


def _code(cell: Cell, ran: Ran, source_link: str, download: str) -> dict[str, Any]:
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
        "metadata": {"spinbook": about},
        "source": cell.source.rstrip("\n"),
        "outputs": outputs,
        "execution_count": None,
    }


def _after(cell: Cell) -> str:
    """What a node that is shown in pieces runs with, in words."""
    with_what = [*cell.after] or (["the usual imports"] if cell.before else [])
    return f"runs with {', '.join(with_what)}" if with_what else ""


def _run(cell: Cell) -> dict[str, Any]:
    """What a page adds to code that is not whole by itself, what `ros2 run` calls a node, how long output is shown."""
    how = ["--main"] if cell.runs_main else ["--class", *cell.spin_classes] if cell.spin_classes else []
    names = [f"{package}/{executable}" for package, executable in cell.executables]
    about: dict[str, Any] = {"before": cell.before, "start": how, "executables": names}
    about |= {"seconds": cell.seconds, "until": cell.until, "raises": cell.raises}
    return {key: value for key, value in about.items() if value}


def _published(output: dict[str, Any]) -> dict[str, Any]:
    """An output as the page shows it: pictures as small as they can be, and only what a page can show."""
    if "data" not in output:
        return output
    data = dict(output["data"])
    for kind in [kind for kind in data if kind not in _SHOWN]:
        del data[kind]
    if "image/svg+xml" in data:
        data.pop("image/png", None)
    if "image/png" in data:
        data["image/png"] = smaller(data["image/png"])
    return {**output, "data": data}


_SHOWN = ("image/svg+xml", "image/png", "text/plain")


def is_picture(output: Mapping[str, Any]) -> bool:
    """Whether an output has a picture in it."""
    return any(kind.startswith("image/") for kind in output.get("data", {}))


def alternative(output: Mapping[str, Any], cell: Cell) -> str:
    """What a picture says in words: what its maker says, else what a terminal would show, else where it is from."""
    for about in output.get("metadata", {}).values():
        if isinstance(about, dict) and about.get("alt"):
            return str(about["alt"])
    plain = output["data"].get("text/plain", "")
    plain = "".join(plain)
    if plain and not plain.startswith("<"):
        return plain
    return f"What {cell.source.strip().splitlines()[0]} draws"


def stills(chapter: Chapter, ran: Ran) -> dict[str, bytes]:
    """The files that stand for the chapter's moving pictures where nothing may move: path in the site -> PNG."""
    found = [still_of(output) for cell in chapter.cells for output in ran.outputs(cell.id)]
    return {still.path: still.data for still in found if still}


def as_text(notebook: Mapping[str, Any]) -> str:
    """The notebook as a file holds it."""
    return json.dumps(notebook, ensure_ascii=False, indent=1, sort_keys=True) + "\n"


__all__ = [
    "node_graph_excerpt",
    "node_graph_html",
    "node_graph_of",
    "node_graph_section",
    "node_graph_svg",
    "read_node_graph",
]

#: How many parts of a graph are enough to show what one looks like.
_PARTS = 2


def node_graph_of(course: Course, chapter: Chapter) -> NodeGraph | None:
    """The graph that was seen while the chapter ran; None where no node was."""
    graph = read_node_graph(course.build_folder / "executed" / f"{chapter.name}.graph.json")
    return graph if graph and graph.nodes else None


def read_node_graph(file: Path) -> NodeGraph | None:
    """The graph in build/executed/NAME.graph.json; None where there is none that can be read."""
    try:
        return NodeGraph.from_json(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def node_graph_html(graph: NodeGraph) -> str:
    """One line of HTML with a small picture for each part of the graph; they stand side by side where there is room.

    Needs no style. A page may set `--node-graph-node` and `--node-graph-topic`, the colours of the boxes.
    """
    return _together(node_graph_svgs(graph))


def node_graph_excerpt(graph: NodeGraph) -> str:
    """As `node_graph_html`, with the parts only that have the most nodes."""
    parts = zip(drawings(graph), node_graph_svgs(graph), strict=True)
    largest = sorted(parts, key=lambda part: len(part[0].nodes), reverse=True)
    return _together([svg for _, svg in largest[:_PARTS]])


def node_graph_section(graph: NodeGraph) -> str:
    """The section of a chapter's page, in Markdown."""
    return f"""\
## The nodes, as they were seen

This picture was not drawn by hand: it is the ROS graph, watched while the outputs of this page were made. Round shapes
are nodes. Boxes are topics, with their types, and with their rates where these were measured. Along a dashed arrow
nothing flows, because no other end fits.

{node_graph_html(graph)}
"""


def _together(parts: list[str]) -> str:
    return f'<div class="node-graph">{" ".join(parts)}</div>'
