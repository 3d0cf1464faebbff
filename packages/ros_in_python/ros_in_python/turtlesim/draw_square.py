"""The node `draw_square`, which drives turtle1 round a square: `python -m ros_in_python.turtlesim.draw_square`."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_srvs.srv import Empty

from ros_in_python.spinning import spin_until_stopped
from ros_in_python.turtlesim.events import DT, normalized
from ros_in_python.turtlesim.messages import Pose

#: Side of the square (units), speeds (units/s and rad/s), and how near is near enough (units, rad; units/s, rad/s).
SIDE, SPEED, TURN = 2.0, 1.0, 0.4
NEAR, NEAR_ANGLE, AT_REST = 0.1, 0.01, 1e-4


class DrawSquare:
    """Drives turtle1 from side to corner to side; begins when the turtlesim has been reset."""

    def __init__(self) -> None:
        self.node = Node("draw_square")
        self._pose: Any = None
        self._velocities = self._square()
        self._twists = self.node.create_publisher(Twist, "turtle1/cmd_vel", 1)
        self._reset = self.node.create_client(Empty, "reset")
        self._reset_answer: Any = None
        self.node.create_subscription(Pose, "turtle1/pose", self._on_pose, 1)
        self.node.create_timer(DT, self._step)

    @property
    def _is_reset(self) -> bool:
        return self._reset_answer is not None and self._reset_answer.done()

    def _on_pose(self, pose: Pose) -> None:
        if self._is_reset:
            self._pose = pose

    def _step(self) -> None:
        if self._reset_answer is None:
            if self._reset.service_is_ready():
                self._reset_answer = self._reset.call_async(Empty.Request())
        elif self._is_reset and self._pose is not None:
            twist = Twist()
            twist.linear.x, twist.angular.z = next(self._velocities)
            self._twists.publish(twist)

    def _square(self) -> Iterator[tuple[float, float]]:
        """Yield the velocities for each step, forward and turning: along a side, at rest, round a corner, at rest …."""
        log = self.node.get_logger()
        while True:
            for velocities, goal_from in (((SPEED, 0.0), _ahead), ((0.0, TURN), _turned)):
                goal = goal_from(self._pose)
                log.info(f"New goal [{goal.x:f} {goal.y:f}, {goal.theta:f}]")
                while not _is_near(self._pose, goal):
                    yield velocities
                while max(abs(self._pose.linear_velocity), abs(self._pose.angular_velocity)) >= AT_REST:
                    yield 0.0, 0.0
                log.info("Reached goal")


def _ahead(pose: Pose) -> Pose:
    """Return the end of a side that begins at `pose`."""
    return Pose(x=pose.x + math.cos(pose.theta) * SIDE, y=pose.y + math.sin(pose.theta) * SIDE, theta=pose.theta)


def _turned(pose: Pose) -> Pose:
    """Return `pose` after a corner."""
    return Pose(x=pose.x, y=pose.y, theta=normalized(pose.theta + math.pi / 2))


def _is_near(pose: Pose, goal: Pose) -> bool:
    turn = normalized(pose.theta - goal.theta)
    return abs(pose.x - goal.x) < NEAR and abs(pose.y - goal.y) < NEAR and abs(turn) < NEAR_ANGLE


def main() -> int:
    """Run the node until it is stopped; return the exit code."""
    return spin_until_stopped(lambda: DrawSquare().node)


if __name__ == "__main__":
    sys.exit(main())
