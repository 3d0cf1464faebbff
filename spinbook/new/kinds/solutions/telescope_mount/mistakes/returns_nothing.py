"""Returns no result.

Caught by:
- test_serves_a_goal
"""

import math

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from turtlesim.action import RotateAbsolute

LIMIT = 1.5  # rad, to either side
STEP = 0.1  # rad
PERIOD = Duration(seconds=0.5)


class TelescopeMount(Node):
    """Serves one goal at a time."""

    def __init__(self):
        super().__init__("telescope_mount")
        self.angle = 0.0  # rad, where the telescope points
        self.busy = False  # is there a goal that is not done?
        self.server = ActionServer(
            self,
            RotateAbsolute,
            "/point",
            self.execute,
            goal_callback=self.on_goal,
            cancel_callback=self.on_cancel,
        )

    def on_goal(self, goal):
        """Called once for each goal. Returns whether it is accepted."""
        if self.busy or not -LIMIT <= goal.theta <= LIMIT:
            return GoalResponse.REJECT
        self.busy = True
        return GoalResponse.ACCEPT

    def on_cancel(self, handle):
        """Called when a client wants the goal to be canceled."""
        return CancelResponse.ACCEPT

    def execute(self, handle):
        """Called once for each accepted goal, in a thread of its own. What it returns is the goal's result."""
        begin, goal = self.angle, handle.request.theta
        while self.angle != goal:
            self.get_clock().sleep_for(PERIOD)
            if handle.is_cancel_requested:
                handle.canceled()
                break
            self.turn(goal)
            handle.publish_feedback(RotateAbsolute.Feedback(remaining=goal - self.angle))
        else:
            handle.succeed()
        self.busy = False

    def turn(self, goal):
        """Turn one step towards the goal (rad), or onto it where that is nearer."""
        remaining = goal - self.angle
        self.angle = goal if abs(remaining) <= STEP else self.angle + math.copysign(STEP, remaining)


def main():
    rclpy.init()
    node = TelescopeMount()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
