"""With a MultiThreadedExecutor, and a lock where one is needed."""

import math
import threading

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity')
        self.lock = threading.Lock()
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        group = MutuallyExclusiveCallbackGroup()
        self.create_subscription(JointState, '/joint_commands', self.locked, 10, callback_group=group)
        self.stamp = None
        self.before = {}

    def locked(self, message):
        with self.lock:
            self.on_joints(message)

    def on_joints(self, message):
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        now = {n: p for n, p in zip(message.name, message.position) if math.isfinite(p)}
        if self.stamp is not None and stamp > self.stamp:
            dt = (stamp - self.stamp) / 1e9
            answer = JointState(header=message.header)
            for name in now:
                if name in self.before:
                    answer.name.append(name)
                    answer.velocity.append((now[name] - self.before[name]) / dt)
            if answer.name:
                self.publisher.publish(answer)
        self.stamp, self.before = stamp, now


def main():
    rclpy.init()
    node = JointVelocity()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
