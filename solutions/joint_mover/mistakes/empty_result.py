"""The result does not have the position.

Caught by:
- test_result_is_the_position
"""

import rclpy
from humanoid_control_interfaces.action import MoveJoint
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
            MoveJoint,
            '/move_joint',
            self.execute,
            goal_callback=self.on_goal,
            cancel_callback=self.on_cancel,
            callback_group=ReentrantCallbackGroup(),
        )
        self.get_logger().info('The joint is at 0.0 rad')

    def on_goal(self, goal):
        if LOWER <= goal.position <= UPPER:
            return GoalResponse.ACCEPT
        return GoalResponse.REJECT

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        self.current = goal_handle
        target = goal_handle.request.position
        while self.position != target:
            self.get_clock().sleep_for(PERIOD)
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return MoveJoint.Result(position=self.position)
            if self.current is not goal_handle:
                goal_handle.abort()
                return MoveJoint.Result(position=self.position)
            self.position = max(self.position - STEP, min(target, self.position + STEP))
            goal_handle.publish_feedback(MoveJoint.Feedback(position=self.position))
        goal_handle.succeed()
        return MoveJoint.Result()


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
