"""The node `turtle_mimic`, which lets one turtle move as another does: `python -m ros_in_python.turtlesim.mimic`.

Both ends are remapped: `--ros-args -r input/pose:=turtle1/pose -r output/cmd_vel:=turtle2/cmd_vel`.
"""

from __future__ import annotations

import sys

from geometry_msgs.msg import Twist
from rclpy.node import Node

from ros_in_python.spinning import spin_until_stopped
from ros_in_python.turtlesim.messages import Pose


def make() -> Node:
    """Make the node: each pose that it gets becomes a command with the same velocities."""
    node = Node("turtle_mimic")
    twists = node.create_publisher(Twist, "output/cmd_vel", 1)

    def follow(pose: Pose) -> None:
        twist = Twist()
        twist.linear.x, twist.angular.z = pose.linear_velocity, pose.angular_velocity
        twists.publish(twist)

    node.create_subscription(Pose, "input/pose", follow, 1)
    return node


def main() -> int:
    """Run the node until it is stopped; return the exit code."""
    return spin_until_stopped(make)


if __name__ == "__main__":
    sys.exit(main())
