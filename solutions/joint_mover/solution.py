"""Move the left elbow to a position, step by step, as an action."""

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
        # TODO: create the action server '/move_joint' (MoveJoint).
        # TODO: see to it that goals and cancel requests are answered while execute runs.
        # BEGIN SOLUTION
        self.actions = ActionServer(
            self,
            MoveJoint,
            '/move_joint',
            self.execute,
            callback_group=ReentrantCallbackGroup(),
            cancel_callback=self.on_cancel,
            goal_callback=self.on_goal,
        )
        # END SOLUTION
        self.get_logger().info('The joint is at 0.0 rad')

    def on_goal(self, goal):
        """Called for each goal: accept or reject it."""
        # TODO: reject what the joint can't reach.
        # BEGIN SOLUTION
        if LOWER <= goal.position <= UPPER:
            return GoalResponse.ACCEPT
        # END SOLUTION
        return GoalResponse.REJECT

    def on_cancel(self, goal_handle):
        """Called for each request to cancel: accept or reject it."""
        # TODO: let every goal be canceled.
        # BEGIN SOLUTION
        return CancelResponse.ACCEPT
        # END SOLUTION

    def execute(self, goal_handle):
        """Called for each goal that was accepted. Runs in a thread of its own."""
        # TODO: move the joint by one step every 0.1 s, with feedback, until it is there.
        # TODO: before each step, see whether the goal was canceled, or replaced by a newer one.
        # TODO: say how the goal ended, and return where the joint is.
        # BEGIN SOLUTION
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
        # END SOLUTION


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
