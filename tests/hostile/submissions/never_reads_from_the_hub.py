"""Keeps a connection to the hub on which it never reads, and another that it never finishes a frame on."""

import math
import os
import socket
import struct

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState

HELLO = struct.pack('<IBIIIB', 14, ord('H'), 1, 2, 0, 1) + struct.pack('<IB', 1, ord('J'))
deaf = [socket.socket(socket.AF_UNIX) for _ in range(2)]
for connection, sent in zip(deaf, (HELLO, HELLO[:7])):
    connection.connect(os.environ['RMW_LOCKSTEP_SOCKET'])
    connection.sendall(sent)


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity')
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
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


if __name__ == '__main__':
    main()
