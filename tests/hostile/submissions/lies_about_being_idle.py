"""Says over a connection of its own, before every answer, that it has nothing left to do."""

import math
import os
import socket
import struct
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState

HELLO = struct.pack('<IBIIIB', 14, ord('H'), 1, os.getpid(), 0, 1)
IDLE = struct.pack('<IBQqqIIIBH', 40, ord('I'), 2**63, 2**62, -1, 0, 0, 0, 0, 0)
liar = socket.socket(socket.AF_UNIX)
liar.connect(os.environ['RMW_LOCKSTEP_SOCKET'])
try:
    liar.sendall(HELLO + 1000 * IDLE)
except OSError:
    pass
time.sleep(0.01)


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
