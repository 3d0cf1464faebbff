"""Counts a goal as rejected if the server has not accepted it after 1 s.

Caught by:
- test_server_that_answers_late
"""

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

    def __init__(self):
        super().__init__('joint_operator')
        self.outcomes = self.create_publisher(String, '/outcomes', 10)
        self.progress = self.create_publisher(Float64, '/progress', 10)
        self.client = ActionClient(self, MoveJoint, '/move_joint')
        self.create_subscription(Float64, '/targets', self.on_target, 10)
        self.create_timer(0.1, self.tick)
        self.waiting = []  # targets, rad
        self.busy = False  # whether a goal is under way
        self.goal_handle = None  # of the goal that was accepted
        self.cancel_at = None  # when it is to be canceled
        self.accepted_by = None  # when the server must have accepted it
        self.get_logger().info('Waiting for targets')

    def on_target(self, message):
        self.waiting.append(message.data)
        self.send()

    def tick(self):
        self.send()
        if self.accepted_by is not None and self.get_clock().now() >= self.accepted_by:
            self.end('rejected')
        if self.cancel_at is not None and self.get_clock().now() >= self.cancel_at:
            self.cancel_at = None
            self.goal_handle.cancel_goal_async()

    def send(self):
        if self.waiting and not self.busy and self.client.server_is_ready():
            self.busy = True
            self.accepted_by = self.get_clock().now() + Duration(seconds=1.0)
            goal = MoveJoint.Goal(position=self.waiting.pop(0))
            self.client.send_goal_async(goal, self.on_feedback).add_done_callback(self.on_response)

    def on_response(self, future):
        if self.accepted_by is None:
            return
        self.accepted_by = None
        goal_handle = future.result()
        if not goal_handle.accepted:
            self.end('rejected')
            return
        self.goal_handle = goal_handle
        self.cancel_at = self.get_clock().now() + LONGEST
        goal_handle.get_result_async().add_done_callback(self.on_result)

    def on_feedback(self, message):
        self.progress.publish(Float64(data=message.feedback.position))

    def on_result(self, future):
        self.end(OUTCOMES[future.result().status])

    def end(self, outcome):
        self.outcomes.publish(String(data=outcome))
        self.busy = False
        self.accepted_by = None
        self.goal_handle = self.cancel_at = None
        self.send()



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
