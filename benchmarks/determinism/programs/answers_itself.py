"""Publishes on the topic that it listens to: it answers its own messages, and is never done with the first one."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_commands', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)

    def on_joints(self, message):
        self.publisher.publish(JointState(header=message.header, name=message.name, velocity=message.position))


rclpy.init()
node = Relay()
rclpy.spin(node)
