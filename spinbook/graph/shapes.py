"""What is drawn of a node graph: boxes for nodes and topics, arrows between them; the ones that belong together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from spinbook.graph.model import NodeGraph, Topic

#: More topics than this that one node has for itself alone are drawn as one box.
_ALONE = 2


@dataclass(frozen=True)
class Box:
    """A node or a topic. `name` is unique among its kind; `small` are the lines below the name."""

    kind: Literal["node", "topic"]
    name: str
    label: str
    small: tuple[str, ...] = ()
    about: str = ""


@dataclass(frozen=True)
class Arrow:
    """From the node to the topic it publishes on, or from the topic to the node that subscribes to it."""

    node: str
    topic: str
    publishes: bool
    connected: bool


@dataclass(frozen=True)
class Drawing:
    """Boxes and arrows of nodes and topics that belong together."""

    nodes: tuple[Box, ...]
    topics: tuple[Box, ...]
    arrows: tuple[Arrow, ...]


def drawings(graph: NodeGraph) -> list[Drawing]:
    """A drawing for each group of nodes that topics connect, in the order of the graph's nodes.

    A graph without a node has none. What a node publishes and nobody hears is drawn as one box where it is much.
    """
    topics = [*_folded(graph.topics)]
    whole = [_drawing(graph, topics, names) for names in _groups(graph, topics)]
    return [drawing for drawing in whole if drawing.nodes]


@dataclass(frozen=True)
class _Drawn:
    box: Box
    arrows: tuple[Arrow, ...]


def _folded(topics: Iterable[Topic]) -> Iterator[_Drawn]:
    """The topics as boxes; those that a node has for itself alone as one, where they are many."""
    alone: dict[tuple[str, bool], list[Topic]] = {}
    for topic in topics:
        nodes = {end.node for end in (*topic.publishers, *topic.subscriptions)}
        if len(nodes) == 1 and not (topic.publishers and topic.subscriptions):
            alone.setdefault((nodes.pop(), bool(topic.publishers)), []).append(topic)
        else:
            yield _drawn(topic)
    for (node, publishes), own in alone.items():
        if len(own) <= _ALONE:
            yield from map(_drawn, own)
            continue
        what = "to which nobody subscribes" if publishes else "that nobody publishes"
        names = ", ".join(topic.name for topic in own)
        name = f"{node} {publishes}"
        box = Box("topic", name, f"{len(own)} topics", (what,), f"{len(own)} topics {what}: {names}")
        yield _Drawn(box, (Arrow(node, name, publishes, False),))


def _drawn(topic: Topic) -> _Drawn:
    small = [*topic.types]
    if topic.rate_hz is not None:
        small.append(f"{topic.rate_hz:g} Hz")
    arrows = [
        Arrow(node, topic.name, publishes, any(end.connected for end in ends if end.node == node))
        for publishes, ends in ((True, topic.publishers), (False, topic.subscriptions))
        for node in dict.fromkeys(end.node for end in ends)
    ]
    return _Drawn(Box("topic", topic.name, topic.name, tuple(small)), tuple(arrows))


def _groups(graph: NodeGraph, topics: list[_Drawn]) -> list[set[str]]:
    """The names of nodes that are connected by topics, directly or by way of others."""
    group = {node.name: {node.name} for node in graph.nodes}
    for topic in topics:
        together: set[str] = set()
        for arrow in topic.arrows:
            together |= group.get(arrow.node, set())
        for name in together:
            group[name] = together
    return list({id(each): each for each in group.values()}.values())


def _drawing(graph: NodeGraph, topics: list[_Drawn], names: set[str]) -> Drawing:
    nodes = [Box("node", node.name, _short(node.name)) for node in graph.nodes if node.name in names]
    own = [topic for topic in topics if any(arrow.node in names for arrow in topic.arrows)]
    arrows = [arrow for topic in own for arrow in topic.arrows if arrow.node in names]
    return Drawing(tuple(nodes), tuple(topic.box for topic in own), tuple(arrows))


def _short(full_name: str) -> str:
    """The name as people say it: without the root namespace."""
    return full_name[1:] if full_name.count("/") == 1 else full_name
