"""Publish each message's joints again, with their positions as velocities."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)

    def answer(self, message, name=''):
        names = [name + joint for joint in message.name]
        self.publisher.publish(JointState(header=message.header, name=names, velocity=message.position))

    def on_joints(self, message):
        self.answer(message)


rclpy.init()
node = Relay()
rclpy.spin(node)
