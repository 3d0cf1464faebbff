"""One graph of a whole chapter from what was seen at the end of each of its cells."""

from __future__ import annotations

from spinbook.graph.model import End, NodeGraph, SeenNode, Topic


class History:
    """Everything that was there at the end of some cell."""

    def __init__(self) -> None:
        self._nodes: dict[str, tuple[str, str]] = {}
        self._publishers: dict[str, dict[tuple[str, str], bool]] = {}
        self._subscriptions: dict[str, dict[tuple[str, str], bool]] = {}
        self._rates: dict[str, float] = {}

    def add(self, cell: str, graph: NodeGraph) -> None:
        """What was seen at the end of a cell."""
        for node in graph.nodes:
            first, _ = self._nodes.get(node.name, (cell, cell))
            self._nodes[node.name] = (first, cell)
        for topic in graph.topics:
            _merge(self._publishers.setdefault(topic.name, {}), topic.publishers)
            _merge(self._subscriptions.setdefault(topic.name, {}), topic.subscriptions)
            if topic.rate_hz is not None:
                self._rates[topic.name] = topic.rate_hz

    def graph(self) -> NodeGraph:
        """All of it, nodes in the order in which they came.

        Ends that were connected at some time are, and a topic's rate is the last one counted.
        """
        nodes = (SeenNode(name, first, last) for name, (first, last) in self._nodes.items())
        topics = (
            Topic(name, _ends(self._publishers[name]), _ends(self._subscriptions[name]), self._rates.get(name))
            for name in sorted(self._publishers)
        )
        return NodeGraph(tuple(nodes), tuple(topics))


def _merge(ends: dict[tuple[str, str], bool], more: tuple[End, ...]) -> None:
    for end in more:
        ends[end.node, end.type] = end.connected or ends.get((end.node, end.type), False)


def _ends(ends: dict[tuple[str, str], bool]) -> tuple[End, ...]:
    return tuple(sorted(End(node, kind, connected) for (node, kind), connected in ends.items()))
