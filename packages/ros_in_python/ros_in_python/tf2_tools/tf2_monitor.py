"""tf2_ros's tf2_monitor: who sends which frames, how often and how late.

ros2 run tf2_ros tf2_monitor
ros2 run tf2_ros tf2_monitor world turtle1
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from rclpy.node import Node
from rclpy.time import Time
from rclpy.utilities import remove_ros_args

from ros_in_python.spinning import spin_until_stopped

#: How often it prints (s).
PERIOD_S = 1.0


@dataclass
class FrameArrivals:
    """When a frame's transforms came, and how late (s)."""

    parent: str
    is_static: bool
    times: list[float] = field(default_factory=list)
    delays: list[float] = field(default_factory=list)

    def line(self, name: str) -> str:
        """Return the frame's line in the report."""
        if self.is_static:
            return f"Frame: {name}, published by <no authority available>, static"
        average = sum(self.delays) / len(self.delays)
        return (
            f"Frame: {name}, published by <no authority available>, Average Delay: {average:g}, "
            f"Max Delay: {max(self.delays):g}, Rate: {_rate(self.times):.3f} Hz"
        )


def _rate(times: Sequence[float]) -> float:
    span = times[-1] - times[0]
    return (len(times) - 1) / span if span > 0 else 0.0


def main(words: Sequence[str]) -> int:
    """Print reports until stopped; return the exit code."""
    parser = argparse.ArgumentParser("tf2_monitor")
    parser.add_argument("frames", nargs="*", metavar="FRAME", help="two frames: watch the chain between them")
    options = parser.parse_args(remove_ros_args(list(words)))
    if len(options.frames) not in (0, 2):
        parser.error("give no frame, or two")
    return spin_until_stopped(lambda: _monitor(options.frames))


class FrameMonitor:
    """Counts what arrives, and prints a report every second."""

    def __init__(self, node: Node, chain: Sequence[str]) -> None:
        from tf2_msgs.msg import TFMessage
        from tf2_ros import Buffer, TransformListener

        self._node, self._chain, self._buffer = node, chain, Buffer()
        self._arrivals: dict[str, FrameArrivals] = {}
        listener = TransformListener(self._buffer, node)
        node.create_subscription(TFMessage, "/tf", self._take, 100)
        node.create_subscription(TFMessage, "/tf_static", self._take_static, listener.tf_static_sub.qos_profile)
        node.create_timer(PERIOD_S, self._report)

    def _take(self, message: Any) -> None:
        now = self._node.get_clock().now().nanoseconds / 1e9
        for one in message.transforms:
            seen = self._arrivals.setdefault(one.child_frame_id, FrameArrivals(one.header.frame_id, is_static=False))
            seen.times.append(now)
            seen.delays.append(now - Time.from_msg(one.header.stamp).nanoseconds / 1e9)

    def _take_static(self, message: Any) -> None:
        for one in message.transforms:
            self._arrivals[one.child_frame_id] = FrameArrivals(one.header.frame_id, is_static=True)

    def _report(self) -> None:
        print(report(self._buffer, self._arrivals, self._chain), flush=True)


def _monitor(chain: Sequence[str]) -> Node:
    node = Node("tf2_monitor")
    FrameMonitor(node, chain)
    return node


def report(buffer: Any, arrivals: dict[str, FrameArrivals], chain: Sequence[str]) -> str:
    """Return the report of one moment: the chain between two frames, if they are given, and every frame."""
    from tf2_ros import TransformException

    lines = ["", ""]
    if chain:
        try:
            common = buffer.get_latest_common_time(*chain).nanoseconds / 1e9
            lines += [f"RESULTS: for {chain[0]} to {chain[1]}", f"Newest time of the whole chain: {common:.3f}"]
        except TransformException as error:
            lines += [f"RESULTS: for {chain[0]} to {chain[1]}", f"Waiting for transform: {error}"]
    lines += ["Frames:", *(seen.line(name) for name, seen in sorted(arrivals.items()))]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
