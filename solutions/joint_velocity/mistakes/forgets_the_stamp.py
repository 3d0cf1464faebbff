"""Leaves the header as it was created, without a stamp.

Caught by:
- test_stamp_is_copied
"""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.stamp = None
        self.before = {}

    def on_joints(self, message):
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        now = {n: p for n, p in zip(message.name, message.position) if math.isfinite(p)}
        if self.stamp is not None and stamp > self.stamp:
            dt = (stamp - self.stamp) / 1e9
            answer = JointState()
            answer.header.frame_id = message.header.frame_id
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
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
