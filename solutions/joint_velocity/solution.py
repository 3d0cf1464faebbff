"""Publish the velocity of each joint, from its positions on /joint_commands."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState

NANOSECONDS = 1_000_000_000


class JointVelocity(Node):
    """Compares each message with the one just before it."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.subscription = self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        # TODO: create a publisher of JointState messages on '/joint_velocities', with a queue depth of 10.
        # TODO: remember that no message has arrived yet.
        # BEGIN SOLUTION
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.stamp_before = None  # ns
        self.positions_before = {}  # joint name -> rad
        # END SOLUTION

    def on_joints(self, message):
        """Called once for each message on /joint_commands."""
        self.get_logger().info(f'{len(message.name)} joints arrived', throttle_duration_sec=1.0)
        # TODO: find dt, the time in seconds between this message's stamp and the stamp of the one just before.
        # TODO: publish the velocity of each joint that is in both messages.
        # TODO: remember this message, even if there was nothing to publish.
        # BEGIN SOLUTION
        stamp = message.header.stamp.sec * NANOSECONDS + message.header.stamp.nanosec
        positions = {
            name: position for name, position in zip(message.name, message.position) if math.isfinite(position)
        }
        if self.stamp_before is not None and stamp > self.stamp_before:
            self.publish_velocities(message, positions, (stamp - self.stamp_before) / NANOSECONDS)
        self.stamp_before = stamp
        self.positions_before = positions
        # END SOLUTION

    # BEGIN SOLUTION
    def publish_velocities(self, message, positions, dt):
        """Publish what is known of the joints of `message`, `dt` seconds after the one before."""
        answer = JointState()
        answer.header = message.header
        for name, position in positions.items():
            if name in self.positions_before:
                answer.name.append(name)
                answer.velocity.append((position - self.positions_before[name]) / dt)
        if answer.name:
            self.publisher.publish(answer)

    # END SOLUTION


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
