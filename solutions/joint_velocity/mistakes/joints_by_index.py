"""Compares joints by their index in the list.

Caught by:
- test_joints_in_another_order
- test_new_joint
- test_joint_that_comes_back
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
        self.before = []

    def on_joints(self, message):
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        now = list(zip(message.name, message.position))
        if self.stamp is not None and stamp > self.stamp:
            dt = (stamp - self.stamp) / 1e9
            answer = JointState(header=message.header)
            for (name, position), (_, before) in zip(now, self.before):
                if math.isfinite(position) and math.isfinite(before):
                    answer.name.append(name)
                    answer.velocity.append((position - before) / dt)
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
