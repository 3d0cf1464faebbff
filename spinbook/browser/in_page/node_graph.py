"""The node graph of the page: at once, as this process knows it, or with rates measured over some seconds."""

from __future__ import annotations

import functools
from typing import Any

from spinbook.graph.layout import drawings
from spinbook.graph.model import NodeGraph
from spinbook.graph.picture import in_words, node_graph_svgs
from spinbook.graph.watcher import GraphWatcher, graph_now


def now() -> dict[str, Any]:
    """Return the graph: `pictures`, an SVG element for each part, and `words`. Never waits."""
    return _shown(_watcher().graph())


@functools.cache
def _watcher() -> GraphWatcher:
    """Return this process's hidden node, which looks at the others."""
    return GraphWatcher()


def counted(seconds: float) -> dict[str, Any]:
    """Return the same as `now`, with message rates measured over this many seconds."""
    return _shown(graph_now(seconds))


def _shown(graph: NodeGraph) -> dict[str, Any]:
    pictures = node_graph_svgs(graph) if graph.nodes else []
    return {"pictures": pictures, "words": in_words(drawings(graph))}
