"""The node graph of a chapter, as it was while the chapter ran, for the chapter's page."""

from __future__ import annotations

from pathlib import Path

from spinbook.graph.model import NodeGraph
from spinbook.graph.picture import node_graph_svg, node_graph_svgs

__all__ = ["node_graph_html", "node_graph_svg", "read_node_graph"]


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
    return f'<div class="node-graph">{" ".join(node_graph_svgs(graph))}</div>'
