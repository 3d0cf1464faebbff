"""A timer for each goal cancels it when it takes too long."""

from collections import deque

import rclpy
from action_msgs.msg import GoalStatus
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64, String


class JointOperator(Node):
    def __init__(self):
        super().__init__('joint_operator')
        self.targets = deque()
        self.under_way = False
        self.alarm = None
        self.outcomes = self.create_publisher(String, '/outcomes', 10)
        self.progress = self.create_publisher(Float64, '/progress', 10)
        self.client = ActionClient(self, MoveJoint, '/move_joint')
        self.subscription = self.create_subscription(Float64, '/targets', self.on_target, 10)
        self.timer = self.create_timer(0.2, self.send)

    def on_target(self, message):
        self.targets.append(message.data)
        self.send()

    def send(self):
        if self.under_way or not self.targets or not self.client.server_is_ready():
            return
        self.under_way = True
        goal = MoveJoint.Goal()
        goal.position = self.targets.popleft()
        future = self.client.send_goal_async(goal, feedback_callback=self.on_feedback)
        future.add_done_callback(self.on_answer)

    def on_feedback(self, message):
        self.progress.publish(Float64(data=message.feedback.position))

    def on_answer(self, future):
        handle = future.result()
        if not handle.accepted:
            self.tell('rejected')
            return
        self.alarm = self.create_timer(5.0, lambda: self.too_long(handle))
        handle.get_result_async().add_done_callback(self.on_result)

    def too_long(self, handle):
        self.alarm.cancel()
        handle.cancel_goal_async()

    def on_result(self, future):
        self.destroy_timer(self.alarm)
        status = future.result().status
        if status == GoalStatus.STATUS_SUCCEEDED:
            self.tell('succeeded')
        elif status == GoalStatus.STATUS_CANCELED:
            self.tell('canceled')
        else:
            self.tell('aborted')

    def tell(self, word):
        self.under_way = False
        self.outcomes.publish(String(data=word))
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
