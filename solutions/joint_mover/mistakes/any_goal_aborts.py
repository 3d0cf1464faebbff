"""Aborts the running goal as soon as another one arrives, even if that one is rejected.

Caught by:
- test_rejected_goal_changes_nothing
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
        self.actions = ActionServer(
            self,
            MoveJoint,
            '/move_joint',
            self.execute,
            callback_group=ReentrantCallbackGroup(),
            cancel_callback=self.on_cancel,
            goal_callback=self.on_goal,
        )
        self.get_logger().info('The joint is at 0.0 rad')

    def on_goal(self, goal):
        self.current = None
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
                break
            if self.current is not goal_handle:
                goal_handle.abort()
                break
            self.position = max(self.position - STEP, min(target, self.position + STEP))
            goal_handle.publish_feedback(MoveJoint.Feedback(position=self.position))
        else:
            goal_handle.succeed()
        return MoveJoint.Result(position=self.position)


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
