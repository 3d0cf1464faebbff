"""With a MultiThreadedExecutor and a lock."""

import threading

import rclpy
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64, String


class JointOperator(Node):
    def __init__(self):
        super().__init__('joint_operator')
        self.lock = threading.RLock()
        self.targets = []
        self.busy = False
        self.goal = None
        self.deadline = None
        group = ReentrantCallbackGroup()
        self.outcomes = self.create_publisher(String, '/outcomes', 10)
        self.progress = self.create_publisher(Float64, '/progress', 10)
        self.client = ActionClient(self, MoveJoint, '/move_joint', callback_group=group)
        self.create_subscription(Float64, '/targets', self.on_target, 10)
        self.create_timer(0.1, self.tick)

    def on_target(self, message):
        with self.lock:
            self.targets.append(message.data)
            self.next()

    def next(self):
        if not self.busy and self.targets and self.client.server_is_ready():
            self.busy = True
            goal = MoveJoint.Goal(position=self.targets.pop(0))
            self.client.send_goal_async(goal, self.on_feedback).add_done_callback(self.on_response)

    def on_feedback(self, message):
        self.progress.publish(Float64(data=message.feedback.position))

    def on_response(self, future):
        with self.lock:
            goal = future.result()
            if goal.accepted:
                self.goal = goal
                self.deadline = self.get_clock().now() + Duration(seconds=5)
                goal.get_result_async().add_done_callback(self.on_result)
            else:
                self.finish('rejected')

    def on_result(self, future):
        with self.lock:
            self.finish({4: 'succeeded', 5: 'canceled', 6: 'aborted'}[future.result().status])

    def finish(self, outcome):
        self.outcomes.publish(String(data=outcome))
        self.goal = self.deadline = None
        self.busy = False
        self.next()

    def tick(self):
        with self.lock:
            self.next()
            if self.deadline and self.get_clock().now() >= self.deadline:
                self.deadline = None
                self.goal.cancel_goal_async()


def main():
    rclpy.init()
    node = JointOperator()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
