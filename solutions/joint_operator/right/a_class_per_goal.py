"""With an object for each goal."""

import rclpy
from action_msgs.msg import GoalStatus
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64, String


class Job:
    def __init__(self, node, target):
        self.node = node
        self.handle = None
        self.canceling = False
        future = node.client.send_goal_async(MoveJoint.Goal(position=target), feedback_callback=self.on_feedback)
        future.add_done_callback(self.on_response)

    def on_feedback(self, message):
        self.node.progress.publish(Float64(data=message.feedback.position))

    def on_response(self, future):
        self.handle = future.result()
        if self.handle.accepted:
            self.since = self.node.get_clock().now().nanoseconds
            self.handle.get_result_async().add_done_callback(self.on_result)
        else:
            self.node.ended('rejected')

    def on_result(self, future):
        status = future.result().status
        names = {GoalStatus.STATUS_SUCCEEDED: 'succeeded', GoalStatus.STATUS_CANCELED: 'canceled'}
        self.node.ended(names.get(status, 'aborted'))

    def tick(self):
        if self.handle is None or self.canceling:
            return
        if self.node.get_clock().now().nanoseconds - self.since >= 5_000_000_000:
            self.canceling = True
            self.handle.cancel_goal_async()


class JointOperator(Node):
    def __init__(self):
        super().__init__('joint_operator')
        self.outcomes = self.create_publisher(String, '/outcomes', 10)
        self.progress = self.create_publisher(Float64, '/progress', 10)
        self.client = ActionClient(self, MoveJoint, '/move_joint')
        self.job = None
        self.targets = []
        self.create_subscription(Float64, '/targets', self.on_target, 10)
        self.create_timer(0.1, self.tick)

    def on_target(self, message):
        self.targets.append(message.data)
        self.begin()

    def begin(self):
        if self.job is None and self.targets and self.client.server_is_ready():
            self.job = Job(self, self.targets.pop(0))

    def ended(self, outcome):
        self.job = None
        self.outcomes.publish(String(data=outcome))
        self.begin()

    def tick(self):
        if self.job is not None:
            self.job.tick()
        self.begin()


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
