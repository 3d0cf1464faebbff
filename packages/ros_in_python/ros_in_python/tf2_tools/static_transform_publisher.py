"""tf2_ros's static_transform_publisher: sends one transform, for as long as it runs.

    ros2 run tf2_ros static_transform_publisher --x 1 --yaw 1.57 --frame-id world --child-frame-id camera

Options are those of ROS 2 Jazzy: https://docs.ros.org/en/jazzy/Tutorials/Intermediate/Tf2/Writing-A-Tf2-Static-Broadcaster-Py.html
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.utilities import remove_ros_args

from ros_in_python.spinning import spin_until_stopped

_ANGLES = ("roll", "pitch", "yaw")
_QUATERNION = ("qx", "qy", "qz", "qw")


def main(words: Sequence[str]) -> int:
    """Publish the transform that the words describe; return the exit code."""
    transform = transform_of(remove_ros_args(list(words)))
    return spin_until_stopped(lambda: _publisher(transform))


def transform_of(words: Sequence[str]) -> TransformStamped:
    """Return the transform (m, rad) that the command's words describe."""
    parser = _parser()
    options = parser.parse_args(_named(parser, list(words)))
    turned = [name for name in _QUATERNION if getattr(options, name) is not None]
    if turned and any(getattr(options, name) for name in _ANGLES):
        parser.error("give either --roll, --pitch and --yaw, or --qx, --qy, --qz and --qw")
    return _message(options, turned)


def _message(options: argparse.Namespace, turned: Sequence[str]) -> TransformStamped:
    from tf2_py.rigid_motion import from_euler, normalized

    message = TransformStamped(child_frame_id=options.child_frame_id)
    message.header.frame_id = options.frame_id
    move, turn = message.transform.translation, message.transform.rotation
    move.x, move.y, move.z = options.x, options.y, options.z
    if turned:
        parts = [getattr(options, name) if getattr(options, name) is not None else 0.0 for name in _QUATERNION]
        turn.x, turn.y, turn.z, turn.w = normalized((parts[0], parts[1], parts[2], parts[3]))
    else:
        turn.x, turn.y, turn.z, turn.w = from_euler(options.roll, options.pitch, options.yaw)
    return message


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("static_transform_publisher", allow_abbrev=False)
    for name in ("x", "y", "z", *_ANGLES):
        unit = "rad" if name in _ANGLES else "m"
        parser.add_argument(f"--{name}", type=float, default=0.0, metavar=unit.upper())
    for name in _QUATERNION:
        parser.add_argument(f"--{name}", type=float, metavar="NUMBER")
    parser.add_argument("--frame-id", required=True, help="the parent frame")
    parser.add_argument("--child-frame-id", required=True, help="the frame that is placed in it")
    return parser


def _named(parser: argparse.ArgumentParser, words: list[str]) -> list[str]:
    """Return words of the old form, `X Y Z YAW PITCH ROLL FRAME CHILD` or with a quaternion, as options."""
    if any(word.startswith("--") for word in words) or len(words) not in (8, 9):
        return words
    names = ("x", "y", "z", "yaw", "pitch", "roll") if len(words) == 8 else ("x", "y", "z", *_QUATERNION)
    options = [f"--{name}={word}" for name, word in zip((*names, "frame-id", "child-frame-id"), words, strict=True)]
    print(f"Old-style arguments are deprecated; write: {' '.join(options)}", file=sys.stderr)
    return options


def _publisher(transform: TransformStamped) -> Node:
    from tf2_ros import StaticTransformBroadcaster

    node = Node("static_transform_publisher")
    transform.header.stamp = node.get_clock().now().to_msg()
    StaticTransformBroadcaster(node).sendTransform(transform)
    move, turn = transform.transform.translation, transform.transform.rotation
    node.get_logger().info(
        "Spinning until stopped - publishing transform\n"
        f"translation: ('{move.x:f}', '{move.y:f}', '{move.z:f}')\n"
        f"rotation: ('{turn.x:f}', '{turn.y:f}', '{turn.z:f}', '{turn.w:f}')\n"
        f"from '{transform.header.frame_id}' to '{transform.child_frame_id}'"
    )
    return node


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
