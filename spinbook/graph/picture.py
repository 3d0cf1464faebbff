"""Draws a node graph as SVG: nodes are round, topics are boxes, and arrows point the way messages go.

The page decides the colours: text and arrows have the colour of the surrounding text (`currentColor`); nodes and topics
have `--node-graph-node` and `--node-graph-topic` if the page sets them. So the SVG fits light and dark pages and needs
no style of its own, which a strict Content-Security-Policy would refuse; it has no script and no font either.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from html import escape

from spinbook.graph.layout import NAME_LINE, SMALL_LINE, Drawing, GraphLayout, PlacedArrow, PlacedBox, drawings, layout
from spinbook.graph.model import NodeGraph

#: Space around a drawing, and between two drawings (px).
_MARGIN, _BETWEEN = 10, 28
_NODE, _TOPIC = "var(--node-graph-node,#0a625d)", "var(--node-graph-topic,#a8690c)"
_FONT = "ui-monospace,SFMono-Regular,Menlo,Consolas,'DejaVu Sans Mono',monospace"
_INHERITED = 'font-size="12" font-weight="600" text-anchor="middle" fill="currentColor" stroke-width="1.4"'
_STANDALONE = (
    "<style>.graph{color:#16211f}.paper{fill:#fff}@media(prefers-color-scheme:dark){.paper{fill:#101817}"
    ".graph{color:#e6eeec;--node-graph-node:#6fd3c8;--node-graph-topic:#e0a94a}}</style>"
)


def node_graph_svg(graph: NodeGraph, *, standalone: bool = False) -> str:
    """Return the whole graph as one SVG element, about 340 px wide at most. Unconnected parts are below each other.

    `standalone` gives it a background and colours of its own, for a file or a notebook's output.
    """
    shown = drawings(graph)
    layouts = layout(shown)
    y, parts = float(_MARGIN), []
    for each in layouts:
        parts.append(f'<g transform="translate({_MARGIN},{_number(y)})">{_drawn(each)}</g>')
        y += each.height + _BETWEEN
    width = max((each.width for each in layouts), default=0) + 2 * _MARGIN
    height = y - _BETWEEN + _MARGIN if layouts else 2 * _MARGIN
    return _element("".join(parts), width, height, in_words(shown), standalone)


def node_graph_svgs(graph: NodeGraph) -> list[str]:
    """Return one SVG element per connected part of the graph. A page can place them side by side."""
    shown = drawings(graph)
    return [
        _element(
            f'<g transform="translate({_MARGIN},{_MARGIN})">{_drawn(each)}</g>',
            each.width + 2 * _MARGIN,
            each.height + 2 * _MARGIN,
            in_words([drawing]),
            False,
        )
        for drawing, each in zip(shown, layout(shown), strict=True)
    ]


def in_words(shown: Iterable[Drawing]) -> str:
    """Return what the picture shows, one sentence per arrow, for readers who can't see it."""
    sentences = []
    for drawing in shown:
        about = {box.name: box.about or _describe(box.label, box.small) for box in drawing.topics}
        for node in drawing.nodes:
            own = [arrow for arrow in drawing.arrows if arrow.node == node.name]
            for publishes, verb in ((True, "publishes"), (False, "subscribes to")):
                topics = [
                    about[a.topic] + ("" if a.connected else " (not connected)")
                    for a in own
                    if a.publishes is publishes
                ]
                if topics:
                    sentences.append(f"{node.label} {verb} {'; '.join(topics)}.")
            if not own:
                sentences.append(f"{node.label} has no topics.")
    return " ".join(sentences) or "No nodes."


def _describe(label: str, small: tuple[str, ...]) -> str:
    return f"{label} ({', '.join(small)})" if small else label


def _element(content: str, width: float, height: float, words: str, standalone: bool) -> str:
    key = "g" + hashlib.sha256((content + words).encode()).hexdigest()[:8]
    paper = ""
    if standalone:
        paper = f'{_STANDALONE}<rect class="paper" width="100%" height="100%" rx="6"/>'
    w, h = _number(width), _number(height)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="graph" width="{w}" height="{h}" viewBox="0 0 {w} {h}" '
        f'role="img" aria-labelledby="{key}t {key}d" font-family="{_FONT}" {_INHERITED}>'
        f'<title id="{key}t">Node graph</title><desc id="{key}d">{escape(words)}</desc>{paper}{content}</svg>'
    )


def _drawn(placed: GraphLayout) -> str:
    paths, heads = "".join(map(_path, placed.lines)), "".join(map(_head, placed.lines))
    arrows = f'<g fill="none" stroke="currentColor" stroke-opacity=".6">{paths}</g><g fill-opacity=".75">{heads}</g>'
    return f"{arrows if placed.lines else ''}{''.join(map(_box, placed.boxes))}"


def _path(line: PlacedArrow) -> str:
    x1, y1, x2, y2 = line.x1, line.y1, line.x2, line.y2
    bend = (x2 - x1) / 2
    if line.arrow.publishes:
        path = f"M{_number(x1)} {_number(y1)}C{_number(x1 + bend)} {_number(y1)} {_number(x2 - bend)} {_number(y2)} "
        path += f"{_number(x2 - 6)} {_number(y2)}"
    else:
        path = f"M{_number(x2)} {_number(y2)}C{_number(x2 - bend)} {_number(y2)} {_number(x1 + bend)} {_number(y1)} "
        path += f"{_number(x1 + 6)} {_number(y1)}"
    dashes = "" if line.arrow.connected else ' stroke-dasharray="3 4"'
    return f'<path d="{path}"{dashes}/>'


def _head(line: PlacedArrow) -> str:
    """Return the arrow's head: at the topic of a publisher, at the node of a subscription."""
    if line.arrow.publishes:
        return f'<path d="M{_number(line.x2)} {_number(line.y2)}l-8-3.5v7z"/>'
    return f'<path d="M{_number(line.x1)} {_number(line.y1)}l8-3.5v7z"/>'


def _box(placed: PlacedBox) -> str:
    node = placed.box.kind == "node"
    colour, radius = (_NODE, min(placed.height / 2, 17)) if node else (_TOPIC, 3)
    shape = (
        f'<rect x="{_number(placed.x)}" y="{_number(placed.y)}" width="{_number(placed.width)}" '
        f'height="{_number(placed.height)}" rx="{_number(radius)}" color="{colour}" fill-opacity=".13" '
        f'stroke="currentColor"/>'
    )
    y = placed.y + (placed.height - NAME_LINE * len(placed.lines) - SMALL_LINE * len(placed.small)) / 2
    x = _number(placed.x + placed.width / 2)
    text = []
    for line in placed.lines:
        y += NAME_LINE
        text.append(f'<text x="{x}" y="{_number(y - 4)}">{escape(line)}</text>')
    for line in placed.small:
        y += SMALL_LINE
        text.append(f'<text x="{x}" y="{_number(y - 3.5)}" font-size="10.5" font-weight="400">{escape(line)}</text>')
    about = f"<title>{escape(placed.box.about)}</title>" if placed.box.about else ""
    return f"<g>{about}{shape}{''.join(text)}</g>"


def _number(value: float) -> str:
    return f"{value:.1f}".removesuffix(".0")
