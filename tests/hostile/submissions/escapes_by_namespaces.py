"""Tries to mount, to change its root, and to make or join namespaces."""

import ctypes
import math
import os

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState

libc = ctypes.CDLL(None, use_errno=True)
for name, result in {
    'unshare': libc.unshare(0x10000000),
    'mount': libc.mount(b'/', b'/tmp', None, 4096, None),
    'chroot': libc.chroot(b'/tmp'),
    'sethostname': libc.sethostname(b'mine', 4),
    'umount': libc.umount2(b'/submission', 2),
    'setuid': libc.setuid(0) or libc.setgid(0) if os.getuid() else -1,
}.items():
    if result == 0:
        print('ESCAPED by', name)
for name in ('net', 'mnt', 'pid', 'user'):
    try:
        if libc.setns(os.open(f'/proc/1/ns/{name}', os.O_RDONLY), 0) == 0:
            print('ESCAPED into', name)
    except OSError:
        pass


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
