"""tf2_tools's view_frames: listens for 5 s, and draws the tree of frames.

    ros2 run tf2_tools view_frames

Writes a picture (SVG), and the same as a graph for Graphviz (.gv), of which `dot -Tpdf FILE.gv` makes a PDF.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import rclpy
import yaml
from rclpy.node import Node

from ros_in_python.animation import coord, on_paper

#: How long it listens (s).
LISTENS_S = 5.0

#: The distance between two frames in the picture, next to and below each other; a frame's height, half a letter (px).
_BESIDE, _BELOW, _HEIGHT, _HALF_CHAR = 260, 120, 34, 4.2


@dataclass(frozen=True)
class FrameInTree:
    """A frame's place in the picture: how many frames are above it, and how far it is from the left."""

    name: str
    depth: int
    across: float


def main(words: Sequence[str]) -> int:
    """Listen, then write `frames_TIME.svg` and `frames_TIME.gv` here; return the exit code."""
    rclpy.init(args=list(words))
    try:
        node = Node("view_frames")
        frames = _listen(node)
        node.destroy_node()
    except KeyboardInterrupt:
        return 1
    finally:
        rclpy.try_shutdown()
    if not frames:
        print("No transform arrived on /tf or /tf_static in 5 s: is a broadcaster running?", file=sys.stderr)
        return 1
    stem = Path(time.strftime("frames_%Y-%m-%d_%H.%M.%S"))
    stem.with_name(f"{stem.name}.gv").write_text(as_graph(frames), encoding="utf-8")
    stem.with_name(f"{stem.name}.svg").write_text(as_svg(frames), encoding="utf-8")
    print(f"Wrote {stem}.svg and {stem}.gv: {len(frames)} transforms.")
    return 0


def _listen(node: Node) -> dict[str, dict[str, Any]]:
    from tf2_ros import Buffer, TransformListener

    buffer = Buffer()
    listener = TransformListener(buffer, node)
    node.get_logger().info("Listening to tf data for 5.0 seconds...")
    until = time.monotonic() + LISTENS_S
    while time.monotonic() < until:
        rclpy.spin_once(node, timeout_sec=0.1)
    listener.unregister()
    return dict(yaml.safe_load(buffer.all_frames_as_yaml()) or {})


def as_graph(frames: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the frames as a graph in Graphviz's language (https://graphviz.org/doc/info/lang.html)."""
    lines = [f'"{one["parent"]}" -> "{name}"[label="{_label(one)}"];' for name, one in frames.items()]
    return "\n".join(["digraph G {", *lines, "}", ""])


def _label(one: Mapping[str, Any]) -> str:
    newest = float(one["most_recent_transform"])
    if newest == 0.0 or float(one["rate"]) == 10000.0:
        return "static or sent once"
    return f"{float(one['rate']):.1f} Hz\\nnewest {newest:.3f} s\\n{float(one['buffer_length']):.3f} s kept"


def places(frames: Mapping[str, Mapping[str, Any]]) -> dict[str, FrameInTree]:
    """Return where each frame is drawn: above the middle of its children; at the top a root, or the first of a ring."""
    children: dict[str, list[str]] = {}
    for name in sorted(frames):
        children.setdefault(str(frames[name]["parent"]), []).append(name)
    drawn: dict[str, FrameInTree] = {}
    for root in (*sorted(children.keys() - frames), *sorted(frames)):
        if root not in drawn:
            _place(root, 0, children, drawn)
    return drawn


def _place(name: str, depth: int, children: Mapping[str, list[str]], drawn: dict[str, FrameInTree]) -> float:
    drawn[name] = FrameInTree(name, depth, -1.0)
    below = [_place(child, depth + 1, children, drawn) for child in children.get(name, []) if child not in drawn]
    across = (below[0] + below[-1]) / 2 if below else max(one.across for one in drawn.values()) + 1
    drawn[name] = FrameInTree(name, depth, across)
    return across


def as_svg(frames: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the frames as a picture: each below its parent, with how often it comes next to its arrow."""
    tree = places(frames)
    width = math.ceil(max(one.across for one in tree.values()) + 1) * _BESIDE
    height = (max(one.depth for one in tree.values()) + 1) * _BELOW
    lines = ((name, str(one["parent"]), _label(one).split("\\n")) for name, one in frames.items())
    arrows = [_arrow(tree[parent], tree[name], label) for name, parent, label in lines]
    head = f'<marker id="head" markerWidth="8" markerHeight="8" refX="7" refY="4" orient="auto">{_HEAD}</marker>'
    content = f'<g class="fi" text-anchor="middle">{head}{"".join(arrows)}{"".join(map(_box, tree.values()))}</g>'
    return on_paper(content, width, height, "f", "The tree of frames", as_graph(frames))


_BLUE = "#4a86b8"
_HEAD = f'<path d="M0 0L8 4L0 8z" fill="{_BLUE}"/>'


def _middle(frame: FrameInTree) -> tuple[float, float]:
    return (frame.across + 0.5) * _BESIDE, (frame.depth + 0.5) * _BELOW


def _box(frame: FrameInTree) -> str:
    x, y = _middle(frame)
    half = _HALF_CHAR * len(frame.name) + 12
    box = f'x="{coord(x - half)}" y="{coord(y - _HEIGHT / 2)}" width="{coord(2 * half)}" height="{_HEIGHT}" rx="8"'
    look = f'fill="{_BLUE}" fill-opacity=".15" stroke="{_BLUE}"'
    return f'<rect {box} {look}/><text x="{coord(x)}" y="{coord(y + 5)}">{escape(frame.name)}</text>'


def _arrow(parent: FrameInTree, child: FrameInTree, label: Sequence[str]) -> str:
    (x, y), (end_x, end_y) = _middle(parent), _middle(child)
    y, end_y = y + _HEIGHT / 2, end_y - _HEIGHT / 2 - 2
    line = f'<path d="M{coord(x)} {coord(y)}L{coord(end_x)} {coord(end_y)}" stroke="{_BLUE}" marker-end="url(#head)"/>'
    at = f'x="{coord((x + end_x) / 2 + 8)}"'
    top = (y + end_y) / 2 + 4 - 7 * (len(label) - 1)
    rows = (f'<tspan {at} y="{coord(top + 14 * row)}">{escape(text)}</tspan>' for row, text in enumerate(label))
    return f'{line}<text font-size="11" text-anchor="start">{"".join(rows)}</text>'


if __name__ == "__main__":
    sys.exit(main(sys.argv))
