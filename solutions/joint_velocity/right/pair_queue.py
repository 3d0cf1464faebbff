"""With a queue that hands on pairs of messages, as message_filters' caches do."""

from collections import deque
from math import isfinite

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Pairs:
    """Keeps two messages and calls back with both."""

    def __init__(self, callback):
        self.kept = deque(maxlen=2)
        self.callback = callback

    def add(self, message):
        self.kept.append(message)
        if len(self.kept) == 2:
            self.callback(*self.kept)


def seconds_between(before, now):
    return (now.sec - before.sec) + (now.nanosec - before.nanosec) * 1e-9


def known(message):
    return {n: p for n, p in zip(message.name, message.position) if isfinite(p)}


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.pairs = Pairs(self.on_pair)
        self.subscription = self.create_subscription(JointState, '/joint_commands', self.pairs.add, 10)

    def on_pair(self, before, now):
        dt = seconds_between(before.header.stamp, now.header.stamp)
        if dt <= 0:
            return
        old, new = known(before), known(now)
        joints = [name for name in new if name in old]
        if joints:
            velocities = [(new[name] - old[name]) / dt for name in joints]
            self.publisher.publish(JointState(header=now.header, name=joints, velocity=velocities))


def main(args=None):
    rclpy.init(args=args)
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
