"""The same node in two processes: both answer each message, and which one is faster is chance."""

import os

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState

CHILD = os.fork() == 0


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)

    def on_joints(self, message):
        names = [('child/' if CHILD else 'parent/') + joint for joint in message.name]
        self.publisher.publish(JointState(header=message.header, name=names, velocity=message.position))


rclpy.init()
node = Relay()
rclpy.spin(node)
