"""The action has another type.

Caught by:
- test_accepts_a_goal
"""

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node

LOWER, UPPER = 0.0, 2.356  # rad
STEP = 0.05  # rad
PERIOD = Duration(seconds=0.1)


class JointMover(Node):

    def __init__(self):
        super().__init__('joint_mover')
        self.position = 0.0  # rad
        self.current = None  # the goal for which the joint moves now
        self.server = ActionServer(
            self,
            Fibonacci,
            '/move_joint',
            self.execute,
            goal_callback=self.on_goal,
            cancel_callback=self.on_cancel,
            callback_group=ReentrantCallbackGroup(),
        )
        self.get_logger().info('The joint is at 0.0 rad')

    def on_goal(self, goal):
        if LOWER <= goal.order <= UPPER:
            return GoalResponse.ACCEPT
        return GoalResponse.REJECT

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        self.current = goal_handle
        target = float(goal_handle.request.order)
        while self.position != target:
            self.get_clock().sleep_for(PERIOD)
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result()
            if self.current is not goal_handle:
                goal_handle.abort()
                return Fibonacci.Result()
            self.position = max(self.position - STEP, min(target, self.position + STEP))
            goal_handle.publish_feedback(Fibonacci.Feedback())
        goal_handle.succeed()
        return Fibonacci.Result()


def main():
    rclpy.init()
    node = JointMover()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
