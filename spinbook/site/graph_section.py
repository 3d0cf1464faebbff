"""Shows on pages the node graph that was recorded while a chapter ran."""

from __future__ import annotations

from pathlib import Path

from spinbook.chapter.chapter import Chapter
from spinbook.course.course import Course
from spinbook.graph.layout import drawings
from spinbook.graph.model import NodeGraph
from spinbook.graph.picture import node_graph_svgs

_WORDS = (
    "This picture was not drawn by hand: it is the ROS graph, watched while the outputs of this page were made. "
    "Round shapes are nodes. Boxes are topics, with their types, and with their rates where these were measured."
)
_DASHED = "Along a dashed arrow nothing flowed: no other end that fits was there at the same time."
#: The home page shows this many parts of a graph, as an example.
_PARTS = 2


def node_graph_of(course: Course, chapter: Chapter) -> NodeGraph | None:
    """Return the graph that was recorded while the chapter ran; None if no node had a topic."""
    graph = read_node_graph(course.build_folder / "executed" / f"{chapter.name}.graph.json")
    return graph if graph and graph.topics else None


def read_node_graph(file: Path) -> NodeGraph | None:
    """Return the graph in build/executed/NAME.graph.json; None if the file is missing or invalid."""
    try:
        return NodeGraph.from_json(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def node_graph_html(graph: NodeGraph) -> str:
    """Return one line of HTML with a small picture per part of the graph, side by side if there is room.

    It needs no style sheet. A page may set `--node-graph-node` and `--node-graph-topic`, the colours of the boxes.
    """
    return _together(node_graph_svgs(graph))


def node_graph_excerpt(graph: NodeGraph) -> str:
    """Return the same as `node_graph_html`, but only the parts with the most nodes."""
    parts = zip(drawings(graph), node_graph_svgs(graph), strict=True)
    largest = sorted(parts, key=lambda part: len(part[0].nodes), reverse=True)
    return _together([svg for _, svg in largest[:_PARTS]])


def node_graph_section(graph: NodeGraph) -> str:
    """Return the section of a chapter's page, in Markdown."""
    picture = node_graph_html(graph)
    words = f"{_WORDS} {_DASHED}" if "stroke-dasharray" in picture else _WORDS
    return f"## The nodes, as they were seen\n\n{words}\n\n{picture}\n"


def _together(parts: list[str]) -> str:
    return f'<div class="node-graph">{" ".join(parts)}</div>'
