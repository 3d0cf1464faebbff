"""Send the joint to one target after another, and report how each of them ended."""

import rclpy
from action_msgs.msg import GoalStatus
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionClient
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64, String

LONGEST = Duration(seconds=5.0)

OUTCOMES = {
    GoalStatus.STATUS_SUCCEEDED: 'succeeded',
    GoalStatus.STATUS_CANCELED: 'canceled',
    GoalStatus.STATUS_ABORTED: 'aborted',
}


class JointOperator(Node):
    """Has one goal under way at a time; other targets wait."""

    def __init__(self):
        super().__init__('joint_operator')
        # TODO: create the publishers of '/outcomes' (String) and '/progress' (Float64).
        # TODO: create the action client of '/move_joint' (MoveJoint).
        # TODO: subscribe to '/targets' (Float64) with self.on_target, and create a timer that calls self.tick at 10 Hz.
        # BEGIN SOLUTION
        self.outcomes = self.create_publisher(String, '/outcomes', 10)
        self.progress = self.create_publisher(Float64, '/progress', 10)
        self.client = ActionClient(self, MoveJoint, '/move_joint')
        self.create_subscription(Float64, '/targets', self.on_target, 10)
        self.create_timer(0.1, self.tick)
        self.waiting = []  # targets, rad
        self.busy = False  # whether a goal is under way
        self.goal_handle = None  # of the goal that was accepted
        self.cancel_at = None  # when it is to be canceled
        # END SOLUTION
        self.get_logger().info('Waiting for targets')

    def on_target(self, message):
        """Called once for each target."""
        # TODO: send a goal, unless one is under way or the server isn't there.
        # BEGIN SOLUTION
        self.waiting.append(message.data)
        self.send()
        # END SOLUTION

    def tick(self):
        """Called ten times per second."""
        # TODO: send what waits. Cancel a goal that takes too long.
        # BEGIN SOLUTION
        self.send()
        if self.cancel_at is not None and self.get_clock().now() >= self.cancel_at:
            self.cancel_at = None
            self.goal_handle.cancel_goal_async()
        # END SOLUTION

    # BEGIN SOLUTION
    def send(self):
        """Send the next goal, if there is one and nothing is in its way."""
        if self.waiting and not self.busy and self.client.server_is_ready():
            self.busy = True
            goal = MoveJoint.Goal(position=self.waiting.pop(0))
            self.client.send_goal_async(goal, self.on_feedback).add_done_callback(self.on_response)

    def on_response(self, future):
        """Called when the server has accepted or rejected the goal."""
        goal_handle = future.result()
        if not goal_handle.accepted:
            self.end('rejected')
            return
        self.goal_handle = goal_handle
        self.cancel_at = self.get_clock().now() + LONGEST
        goal_handle.get_result_async().add_done_callback(self.on_result)

    def on_feedback(self, message):
        """Called for each feedback."""
        self.progress.publish(Float64(data=message.feedback.position))

    def on_result(self, future):
        """Called when the goal has ended."""
        self.end(OUTCOMES[future.result().status])

    def end(self, outcome):
        """Report how the goal ended, and continue with the next."""
        self.outcomes.publish(String(data=outcome))
        self.busy = False
        self.goal_handle = self.cancel_at = None
        self.send()

    # END SOLUTION


def main():
    rclpy.init()
    node = JointOperator()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
