"""The node graph of the page: at once, as this process knows it, or with rates measured over some seconds."""

from __future__ import annotations

from typing import Any

from rcl_python import participant
from rcl_python.graph import PUBLISHER, SUBSCRIPTION, EndpointInfo, Graph, NodeInfo
from rmw_lockstep.qos import compatible
from spinbook.graph.layout import drawings
from spinbook.graph.model import INTERNAL, GraphEndpoint, GraphNode, GraphTopic, NodeGraph, one_each
from spinbook.graph.picture import in_words, node_graph_svgs


def now() -> dict[str, Any]:
    """Return the graph: `pictures`, an SVG element for each part, and `words`. Never waits."""
    here = participant.current()
    here.join()
    here.pump()
    return _shown(node_graph(here.graph))


def counted(seconds: float) -> dict[str, Any]:
    """Return the same as `now`, with message rates measured over this many seconds."""
    from spinbook.graph.watcher import graph_now

    return _shown(graph_now(seconds))


def _shown(graph: NodeGraph) -> dict[str, Any]:
    pictures = node_graph_svgs(graph) if graph.nodes else []
    return {"pictures": pictures, "words": in_words(drawings(graph))}


def node_graph(graph: Graph) -> NodeGraph:
    """Return what `%graph` draws: nodes and topics that are not hidden."""
    nodes = {node.key: _full_name(node) for node in graph.nodes_in(0)}
    shown = {key: name for key, name in nodes.items() if not _is_hidden(name)}
    ends = [end for end in graph.ends(0, PUBLISHER, SUBSCRIPTION) if end.node in shown and _is_shown(end.topic)]
    topics = [_topic(name, ends, shown) for name in sorted({end.topic for end in ends})]
    return NodeGraph(tuple(GraphNode(name) for name in sorted(set(shown.values()))), tuple(topics))


def _topic(name: str, ends: list[EndpointInfo], nodes: dict[str, str]) -> GraphTopic:
    publishers, subscriptions = (
        [end for end in ends if end.topic == name and end.kind == kind] for kind in (PUBLISHER, SUBSCRIPTION)
    )
    return GraphTopic(name, _ends(publishers, subscriptions, nodes), _ends(subscriptions, publishers, nodes))


def _ends(ends: list[EndpointInfo], others: list[EndpointInfo], nodes: dict[str, str]) -> tuple[GraphEndpoint, ...]:
    return one_each(GraphEndpoint(nodes[end.node], end.type, any(_fit(end, other) for other in others)) for end in ends)


def _fit(one: EndpointInfo, other: EndpointInfo) -> bool:
    publisher, subscription = (one, other) if one.kind == PUBLISHER else (other, one)
    return one.type == other.type and compatible(publisher.qos, subscription.qos)


def _full_name(node: NodeInfo) -> str:
    return f"{node.namespace.rstrip('/')}/{node.name}"


def _is_hidden(name: str) -> bool:
    return any(part.startswith("_") for part in name.split("/"))


def _is_shown(topic: str) -> bool:
    return topic not in INTERNAL and not _is_hidden(topic)
