"""A canceled goal puts the joint back to where the goal began.

Caught by:
- test_goal_after_a_cancel
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
    """Has one joint, and moves it for one goal at a time."""

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
        """Called for each goal: accept or reject it."""
        if LOWER <= goal.position <= UPPER:
            return GoalResponse.ACCEPT
        return GoalResponse.REJECT

    def on_cancel(self, goal_handle):
        """Called for each request to cancel: accept or reject it."""
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        """Called for each goal that was accepted. Runs in a thread of its own."""
        self.current = goal_handle
        target = goal_handle.request.position
        began = self.position
        while self.position != target:
            self.get_clock().sleep_for(PERIOD)
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                stopped_at, self.position = self.position, began
                return MoveJoint.Result(position=stopped_at)
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
