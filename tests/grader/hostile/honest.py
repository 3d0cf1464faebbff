"""A right solution of joint_velocity. The hostile programs in submissions.md are edits of it."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointVelocity(Node):
    def __init__(self):
        super().__init__("joint_velocity")
        self.create_subscription(JointState, "/joint_commands", self.on_joints, 10)
        self.publisher = self.create_publisher(JointState, "/joint_velocities", 10)
        self.stamp = None
        self.positions = {}

    def on_joints(self, message):
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        positions = {n: p for n, p in zip(message.name, message.position) if math.isfinite(p)}
        if self.stamp is not None and stamp > self.stamp:
            answer = JointState(header=message.header)
            answer.name = [name for name in positions if name in self.positions]
            answer.velocity = [
                (positions[name] - self.positions[name]) / ((stamp - self.stamp) / 1e9) for name in answer.name
            ]
            if answer.name:
                self.publisher.publish(answer)
        self.stamp, self.positions = stamp, positions


def main():
    rclpy.init()
    node = JointVelocity()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
