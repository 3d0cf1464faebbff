"""Publishes what it receives, and hopes that the velocities are in it."""

import rclpy
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import JointState


def main():
    rclpy.init()
    node = rclpy.create_node('joint_velocity')
    publisher = node.create_publisher(JointState, '/joint_velocities', 10)
    node.create_subscription(JointState, '/joint_commands', publisher.publish, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
