"""tf2_ros's tf2_echo: prints where one frame is in another, once a second.

ros2 run tf2_ros tf2_echo world turtle1
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.time import Time
from rclpy.utilities import remove_ros_args

from ros_in_python.spinning import spin_until_stopped


def main(words: Sequence[str]) -> int:
    """Print the transform until stopped; return the exit code."""
    parser = argparse.ArgumentParser("tf2_echo")
    parser.add_argument("source_frame", help="the frame in which to look from")
    parser.add_argument("target_frame", help="the frame to look at")
    parser.add_argument("rate", type=float, nargs="?", default=1.0, help="how often to print (Hz, default 1)")
    options = parser.parse_args(remove_ros_args(list(words)))
    return spin_until_stopped(lambda: _echo(options.source_frame, options.target_frame, options.rate))


def _echo(source: str, target: str, rate: float) -> Node:
    from tf2_ros import Buffer, TransformException, TransformListener

    node = Node("tf2_echo")
    buffer = Buffer()
    TransformListener(buffer, node)  # the node keeps it, by its subscriptions

    def look() -> None:
        try:
            found = buffer.lookup_transform(source, target, Time())
        except TransformException as error:
            node.get_logger().info(f"Waiting for transform {source} ->  {target}: {error}")
        else:
            print(as_text(found), flush=True)

    node.create_timer(1.0 / rate, look)
    return node


def as_text(found: TransformStamped) -> str:
    """Return a transform as tf2_echo prints it: translation (m), rotation as quaternion, angles and matrix."""
    from tf2_py.rigid_motion import matrix, to_euler

    move, turn, stamp = found.transform.translation, found.transform.rotation, found.header.stamp
    rotation = (turn.x, turn.y, turn.z, turn.w)
    angles = to_euler(rotation)
    rows = zip(matrix(rotation), (move.x, move.y, move.z), strict=True)
    lines = [
        f"At time {stamp.sec}.{stamp.nanosec}",
        f"- Translation: {_row((move.x, move.y, move.z))}",
        f"- Rotation: in Quaternion (xyzw) {_row(rotation)}",
        f"- Rotation: in RPY (radian) {_row(angles)}",
        f"- Rotation: in RPY (degree) {_row([math.degrees(angle) for angle in angles])}",
        "- Matrix:",
        *(" " + "".join(f" {value:6.3f}" for value in (*row, place)) for row, place in rows),
        " " + "".join(f" {value:6.3f}" for value in (0.0, 0.0, 0.0, 1.0)),
    ]
    return "\n".join(lines)


def _row(values: Sequence[float]) -> str:
    return "[" + ", ".join(f"{value:.3f}" for value in values) + "]"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
