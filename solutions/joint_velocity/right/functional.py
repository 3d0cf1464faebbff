"""Without a class: create_node and a closure."""

from math import isfinite

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState


def velocities(before, now):
    """The message to publish for `now`, or None."""
    dt = (nanoseconds(now) - nanoseconds(before)) / 10**9
    if dt <= 0:
        return None
    old, new = positions(before), positions(now)
    found = [(name, (new[name] - old[name]) / dt) for name in new if name in old]
    if not found:
        return None
    names, speeds = zip(*found)
    return JointState(header=now.header, name=names, velocity=speeds)


def nanoseconds(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def positions(message):
    return {n: p for n, p in zip(message.name, message.position) if isfinite(p)}


def main():
    rclpy.init()
    node = rclpy.create_node('joint_velocity')
    publisher = node.create_publisher(JointState, '/joint_velocities', QoSProfile(depth=10))
    last = []

    def on_joints(message):
        answer = velocities(last.pop(), message) if last else None
        last.append(message)
        if answer is not None:
            publisher.publish(answer)

    node.create_subscription(JointState, '/joint_commands', on_joints, QoSProfile(depth=10))
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
