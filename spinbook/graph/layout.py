"""Lays out the boxes and arrows of a node graph: nodes on the left, topics on the right."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from spinbook.graph.model import GraphTopic, NodeGraph

#: More topics than this that only one node uses are drawn as one box.
_ALONE = 2


@dataclass(frozen=True)
class Box:
    """A node or a topic. `name` is unique among its kind; `small` is the small print, `about` the tooltip."""

    kind: Literal["node", "topic"]
    name: str
    label: str
    small: tuple[str, ...] = ()
    about: str = ""


@dataclass(frozen=True)
class Arrow:
    """An arrow from a node to the topic on which it publishes, or from a topic to a node that subscribes to it."""

    node: str
    topic: str
    publishes: bool
    connected: bool


@dataclass(frozen=True)
class Drawing:
    """The boxes and arrows of nodes and topics that are connected."""

    nodes: tuple[Box, ...]
    topics: tuple[Box, ...]
    arrows: tuple[Arrow, ...]


def drawings(graph: NodeGraph) -> list[Drawing]:
    """Return one drawing per group of connected nodes, in the order of the graph's nodes; none for an empty graph.

    If a node has many topics that no other node uses, one box stands for all of them.
    """
    topics = [*_folded(graph.topics)]
    whole = [_drawing(graph, topics, names) for names in _groups(graph, topics)]
    return [drawing for drawing in whole if drawing.nodes]


@dataclass(frozen=True)
class _TopicBox:
    box: Box
    arrows: tuple[Arrow, ...]


def _folded(topics: Iterable[GraphTopic]) -> Iterator[_TopicBox]:
    """Yield the topics as boxes; many topics that only one node uses share one box."""
    alone: dict[tuple[str, bool], list[GraphTopic]] = {}
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
        lonely = "to which no node subscribes" if publishes else "on which no node publishes"
        names = ", ".join(topic.name for topic in own)
        name = f"{node} {publishes}"
        box = Box("topic", name, f"{len(own)} topics", (lonely,), f"{len(own)} topics {lonely}: {names}")
        yield _TopicBox(box, (Arrow(node, name, publishes, False),))


def _drawn(topic: GraphTopic) -> _TopicBox:
    small = [*topic.types]
    if topic.rate_hz is not None:
        small.append(f"{topic.rate_hz:g} Hz")
    arrows = [
        Arrow(node, topic.name, publishes, any(end.connected for end in ends if end.node == node))
        for publishes, ends in ((True, topic.publishers), (False, topic.subscriptions))
        for node in dict.fromkeys(end.node for end in ends)
    ]
    return _TopicBox(Box("topic", topic.name, topic.name, tuple(small)), tuple(arrows))


def _groups(graph: NodeGraph, topics: list[_TopicBox]) -> list[set[str]]:
    """Return the names of nodes in groups that are connected by topics, directly or through other nodes."""
    group = {node.name: {node.name} for node in graph.nodes}
    for topic in topics:
        together: set[str] = set()
        for arrow in topic.arrows:
            together |= group.get(arrow.node, set())
        for name in together:
            group[name] = together
    return list({id(each): each for each in group.values()}.values())


def _drawing(graph: NodeGraph, topics: list[_TopicBox], names: set[str]) -> Drawing:
    nodes = [Box("node", node.name, _short(node.name)) for node in graph.nodes if node.name in names]
    own = [topic for topic in topics if any(arrow.node in names for arrow in topic.arrows)]
    arrows = [arrow for topic in own for arrow in topic.arrows if arrow.node in names]
    return Drawing(tuple(nodes), tuple(topic.box for topic in own), tuple(arrows))


def _short(full_name: str) -> str:
    """Return the name without the root namespace, as people say it."""
    return full_name[1:] if full_name.count("/") == 1 else full_name


# Two columns fit on a phone. A larger graph grows downwards, where a page has room.


#: Widths of one character of a name and of the small print (px): monospaced, 12 and 10.5 px high.
NAME_CHAR, SMALL_CHAR = 7.25, 6.35
NAME_LINE, SMALL_LINE = 16, 14
#: Longest lines of a box (characters).
_NODE_LINE, _TOPIC_LINE, _SMALL_LINE = 16, 17, 20
_GAP_X, _GAP_Y, _PAD = 48, 16, 9

#: Kind and name of a box.
_Key = tuple[str, str]


@dataclass(frozen=True)
class PlacedBox:
    """A box with its upper left corner and size (px), and its text broken into lines."""

    box: Box
    x: float
    y: float
    width: float
    height: float
    lines: tuple[str, ...]
    small: tuple[str, ...]

    @property
    def middle(self) -> float:
        """The y coordinate of its middle (px)."""
        return self.y + self.height / 2


@dataclass(frozen=True)
class PlacedArrow:
    """An arrow from the right side of a node at (x1, y1) to the left side of a topic at (x2, y2)."""

    arrow: Arrow
    x1: float
    y1: float
    x2: float
    y2: float


@dataclass(frozen=True)
class GraphLayout:
    """A drawing with all coordinates, which are within `width` and `height` (px)."""

    boxes: tuple[PlacedBox, ...]
    lines: tuple[PlacedArrow, ...]
    width: float
    height: float


def layout(drawings: Sequence[Drawing]) -> list[GraphLayout]:
    """Place the boxes of each drawing, in columns of the same width for all. The result is deterministic."""
    sizes = {box: _size(box) for drawing in drawings for box in (*drawing.nodes, *drawing.topics)}
    widths = {
        kind: max((size.width for box, size in sizes.items() if box.kind == kind), default=0.0)
        for kind in ("node", "topic")
    }
    return [_place(drawing, sizes, widths) for drawing in drawings]


def _place(drawing: Drawing, sizes: Mapping[Box, _Size], widths: Mapping[str, float]) -> GraphLayout:
    layers = _layers(drawing)
    left = {"node": 0.0, "topic": widths["node"] + _GAP_X}
    bottom = {"node": 0.0, "topic": 0.0}
    placed: dict[_Key, PlacedBox] = {}
    for number in range(max(layers.values()) + 1):
        here = [box for box in (*drawing.nodes, *drawing.topics) if layers[box.kind, box.name] == number]
        best = {box: _best_y(box, drawing.arrows, placed) for box in here}
        for box in sorted(here, key=lambda box: (best[box], here.index(box))):
            size = sizes[box]
            y = max(bottom[box.kind], best[box] - size.height / 2)
            at = PlacedBox(box, left[box.kind], y, widths[box.kind], size.height, size.lines, size.small)
            placed[box.kind, box.name] = at
            bottom[box.kind] = y + size.height + _GAP_Y
    width = max(each.x + each.width for each in placed.values())
    height = max(each.y + each.height for each in placed.values())
    return GraphLayout(tuple(placed.values()), tuple(_lines(drawing.arrows, placed)), width, height)


def _layers(drawing: Drawing) -> Mapping[_Key, int]:
    """Return the layer of each box: the length of the longest path to it, in which a cycle counts once.

    A topic without publishers comes after its subscribers.
    """
    published = {arrow.topic for arrow in drawing.arrows if arrow.publishes}
    after: dict[_Key, list[_Key]] = {(box.kind, box.name): [] for box in (*drawing.nodes, *drawing.topics)}
    for arrow in drawing.arrows:
        node, topic = ("node", arrow.node), ("topic", arrow.topic)
        if arrow.publishes or arrow.topic not in published:
            after[node].append(topic)
        else:
            after[topic].append(node)
    layers = dict.fromkeys(after, 0)

    def push(box: _Key, path: tuple[_Key, ...]) -> None:
        for following in after[box]:
            if following not in path and layers[following] <= layers[box]:
                layers[following] = layers[box] + 1
                push(following, (*path, following))

    reached = {end for ends in after.values() for end in ends}
    for box in [box for box in after if box not in reached] or list(after)[:1]:
        push(box, (box,))
    return layers


def _best_y(box: Box, arrows: tuple[Arrow, ...], placed: Mapping[_Key, PlacedBox]) -> float:
    """Return the best y for a box's middle: the mean of the connected boxes that are placed already."""
    heights = []
    for arrow in arrows:
        node, topic = ("node", arrow.node), ("topic", arrow.topic)
        mine, other = (node, topic) if box.kind == "node" else (topic, node)
        if mine == (box.kind, box.name) and other in placed:
            heights.append(placed[other].middle)
    return sum(heights) / len(heights) if heights else 0.0


@dataclass(frozen=True)
class _Size:
    width: float
    height: float
    lines: tuple[str, ...]
    small: tuple[str, ...]


def _size(box: Box) -> _Size:
    lines = broken(box.label, _NODE_LINE if box.kind == "node" else _TOPIC_LINE)
    small = tuple(line for text in box.small for line in broken(text, _SMALL_LINE, evenly=False))
    width = max([len(line) * NAME_CHAR for line in lines] + [len(line) * SMALL_CHAR for line in small])
    height = 2 * _PAD + NAME_LINE * len(lines) + SMALL_LINE * len(small)
    return _Size(width + 2 * (_PAD + (4 if box.kind == "node" else 0)), height, lines, small)


def broken(text: str, length: int, *, evenly: bool = True) -> tuple[str, ...]:
    """Break a name into lines of at most `length` characters, after / and _ and between words; `evenly` if possible."""
    parts = re.findall(r"[^/_ ]*[/_ ]|[^/_ ]+", text)
    count = -(-len(text) // length)
    for limit in range(-(-len(text) // count) if evenly else length, length + 1):
        lines = _filled(parts, limit)
        if len(lines) <= count and all(len(line) <= length for line in lines):
            return tuple(line.strip() for line in lines)
    filled = _filled(parts, length)
    return tuple(line[at : at + length].strip() for line in filled for at in range(0, len(line), length))


def _filled(parts: list[str], length: int) -> list[str]:
    lines = [""]
    for part in parts:
        if lines[-1] and len(lines[-1]) + len(part.rstrip()) > length:
            lines.append("")
        lines[-1] += part
    return lines


def _lines(arrows: tuple[Arrow, ...], placed: Mapping[_Key, PlacedBox]) -> list[PlacedArrow]:
    """Place the arrows: each ends at a point of its own, ordered so that few arrows cross."""

    def height(kind: str, name: str, arrow: Arrow) -> float:
        box = placed[kind, name]
        own = [each for each in arrows if (each.node if kind == "node" else each.topic) == name]
        other = [("topic", each.topic) if kind == "node" else ("node", each.node) for each in own]
        order = sorted(zip(own, other, strict=True), key=lambda pair: (placed[pair[1]].middle, not pair[0].publishes))
        place = [each for each, _ in order].index(arrow)
        return box.y + box.height * (place + 1) / (len(own) + 1)

    lines = []
    for arrow in arrows:
        node, topic = placed["node", arrow.node], placed["topic", arrow.topic]
        y1, y2 = height("node", arrow.node, arrow), height("topic", arrow.topic, arrow)
        lines.append(PlacedArrow(arrow, node.x + node.width, y1, topic.x, y2))
    return lines
