"""The node `draw_square`, which drives turtle1 round a square: `python -m ros_in_python.turtlesim.draw_square`."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from enum import Enum
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


class Phase(Enum):
    """What the turtle is doing."""

    FORWARD = "forward"
    STOP_FORWARD = "stop after going forward"
    TURN = "turn"
    STOP_TURN = "stop after turning"


@dataclass(frozen=True)
class Corner:
    """Where to be (units) and how to head (rad) at the end of a side or a corner."""

    x: float
    y: float
    theta: float

    def reached(self, x: float, y: float, theta: float) -> bool:
        """Return whether a pose is near enough."""
        return abs(x - self.x) < NEAR and abs(y - self.y) < NEAR and abs(normalized(theta - self.theta)) < NEAR_ANGLE


class DrawSquare:
    """Drives turtle1 from side to corner to side; begins when the turtlesim has been reset."""

    def __init__(self) -> None:
        self.node = Node("draw_square")
        self._phase = Phase.FORWARD
        self._goal: Corner | None = None
        self._pose: Pose | None = None
        self._resting = False
        self._twists = self.node.create_publisher(Twist, "turtle1/cmd_vel", 1)
        self._reset = self.node.create_client(Empty, "reset")
        self._reset_answer: Any = None
        self.node.create_subscription(Pose, "turtle1/pose", self._on_pose, 1)
        self.node.create_timer(DT, self._step)

    def _step(self) -> None:
        if self._reset_answer is None:
            if self._reset.service_is_ready():
                self._reset_answer = self._reset.call_async(Empty.Request())
        elif self._reset_answer.done() and self._pose is not None:
            self._drive(self._pose)

    def _on_pose(self, pose: Pose) -> None:
        if self._reset_answer is not None and self._reset_answer.done():
            self._pose = pose
            self._resting = max(abs(pose.linear_velocity), abs(pose.angular_velocity)) < AT_REST

    def _drive(self, pose: Pose) -> None:
        goal = self._goal
        if goal is None:
            self._begin(Phase.FORWARD, Corner(*_ahead(pose), pose.theta))
        elif self._phase in (Phase.FORWARD, Phase.TURN):
            if goal.reached(pose.x, pose.y, pose.theta):
                self._phase = Phase.STOP_FORWARD if self._phase is Phase.FORWARD else Phase.STOP_TURN
                self._command(0.0, 0.0)
            else:
                self._command(*((SPEED, 0.0) if self._phase is Phase.FORWARD else (0.0, TURN)))
        elif not self._resting:
            self._command(0.0, 0.0)
        else:
            self.node.get_logger().info("Reached goal")
            if self._phase is Phase.STOP_FORWARD:
                self._begin(Phase.TURN, Corner(pose.x, pose.y, normalized(pose.theta + math.pi / 2)))
            else:
                self._begin(Phase.FORWARD, Corner(*_ahead(pose), pose.theta))

    def _begin(self, phase: Phase, goal: Corner) -> None:
        self._phase, self._goal = phase, goal
        self.node.get_logger().info(f"New goal [{goal.x:f} {goal.y:f}, {goal.theta:f}]")

    def _command(self, forward: float, turn: float) -> None:
        twist = Twist()
        twist.linear.x, twist.angular.z = forward, turn
        self._twists.publish(twist)


def _ahead(pose: Pose) -> tuple[float, float]:
    """Return the end of a side that begins at `pose`."""
    return (pose.x + math.cos(pose.theta) * SIDE, pose.y + math.sin(pose.theta) * SIDE)


def main() -> int:
    """Run the node until it is stopped; return the exit code."""
    return spin_until_stopped(lambda: DrawSquare().node)


if __name__ == "__main__":
    sys.exit(main())
