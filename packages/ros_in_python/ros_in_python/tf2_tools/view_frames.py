"""tf2_tools's view_frames: listens for 5 s, and draws the tree of frames.

    ros2 run tf2_tools view_frames

Writes a picture (PDF, by matplotlib), and the same as a graph for Graphviz (.gv).
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import rclpy
import yaml
from rclpy.node import Node

#: How long it listens (s).
LISTENS_S = 5.0

#: The distance between two frames in the picture (inches), beside and below each other.
_BESIDE, _BELOW = 2.6, 1.5


@dataclass(frozen=True)
class FrameInTree:
    """A frame's place in the picture: how many frames are above it, and how far it is from the left."""

    name: str
    depth: int
    across: float


def main(words: Sequence[str]) -> int:
    """Listen, then write `frames_TIME.pdf` and `frames_TIME.gv` here; return the exit code."""
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
    draw(frames, stem.with_name(f"{stem.name}.pdf"))
    print(f"Wrote {stem}.pdf and {stem}.gv: {len(frames)} transforms.")
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
    """Return where each frame is drawn: parents above the middle of their children, roots at the top."""
    children: dict[str, list[str]] = {}
    for name in sorted(frames):
        children.setdefault(str(frames[name]["parent"]), []).append(name)
    drawn: dict[str, FrameInTree] = {}
    for root in sorted(parent for parent in children if parent not in frames):
        _place(root, 0, children, drawn)
    return drawn


def _place(name: str, depth: int, children: Mapping[str, list[str]], drawn: dict[str, FrameInTree]) -> float:
    below = [_place(child, depth + 1, children, drawn) for child in children.get(name, [])]
    leaves = sum(1 for one in drawn.values() if one.name not in children)
    across = (below[0] + below[-1]) / 2 if below else float(leaves)
    drawn[name] = FrameInTree(name, depth, across)
    return across


def draw(frames: Mapping[str, Mapping[str, Any]], file: Path) -> None:
    """Draw the frames into a file of any type that matplotlib knows. Raises SystemExit without matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError:
        sys.exit(f"{file.with_suffix('.gv')} is written. The PDF needs matplotlib: pip install matplotlib")
    tree = places(frames)
    width = max(one.across for one in tree.values()) + 1
    depth = max(one.depth for one in tree.values()) + 1
    figure = Figure(figsize=(_BESIDE * width, _BELOW * depth))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    axes.set(xlim=(-0.5, width - 0.5), ylim=(depth - 0.5, -0.5))
    for name, one in frames.items():
        if name in tree:
            _draw_arrow(axes, tree[str(one["parent"])], tree[name], _label(one).replace("\\n", "\n"))
    for frame in tree.values():
        axes.text(frame.across, frame.depth, frame.name, ha="center", va="center", bbox=_BOX)
    figure.savefig(file)


_BOX = {"boxstyle": "round,pad=0.5", "facecolor": "#eef4fb", "edgecolor": "#33658a"}


def _draw_arrow(axes: Any, parent: FrameInTree, child: FrameInTree, label: str) -> None:
    start, end = (parent.across, parent.depth + 0.2), (child.across, child.depth - 0.2)
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "->", "color": "#33658a"})
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    axes.text(*middle, label, ha="left", va="center", fontsize=7, color="#444444")


if __name__ == "__main__":
    sys.exit(main(sys.argv))
