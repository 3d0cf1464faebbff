"""One coroutine goes through a goal's whole life."""

import rclpy
from action_msgs.msg import GoalStatus
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64, String

WORDS = {4: 'succeeded', 5: 'canceled', 6: 'aborted'}


class JointOperator(Node):
    def __init__(self):
        super().__init__('joint_operator')
        self.queue, self.task, self.goal_handle, self.since = [], None, None, 0
        group = ReentrantCallbackGroup()
        self.outcomes = self.create_publisher(String, '/outcomes', 10)
        self.progress = self.create_publisher(Float64, '/progress', 10)
        self.client = ActionClient(self, MoveJoint, '/move_joint', callback_group=group)
        self.create_subscription(Float64, '/targets', self.on_target, 10)
        self.create_timer(0.1, self.tick)

    def on_target(self, message):
        self.queue.append(message.data)
        self.start()

    def start(self):
        if self.queue and self.task is None and self.client.server_is_ready():
            self.task = self.executor.create_task(self.go_through, self.queue.pop(0))

    async def go_through(self, target):
        handle = await self.client.send_goal_async(MoveJoint.Goal(position=target), self.on_feedback)
        outcome = 'rejected'
        if handle.accepted:
            self.goal_handle, self.since = handle, self.get_clock().now().nanoseconds
            outcome = WORDS[(await handle.get_result_async()).status]
        self.goal_handle = None
        self.outcomes.publish(String(data=outcome))
        self.task = None
        self.start()

    def on_feedback(self, message):
        self.progress.publish(Float64(data=message.feedback.position))

    def tick(self):
        self.start()
        if self.goal_handle is not None and self.get_clock().now().nanoseconds - self.since >= 5 * 10**9:
            assert GoalStatus.STATUS_CANCELED in WORDS
            self.goal_handle.cancel_goal_async()
            self.since = 2**62


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
