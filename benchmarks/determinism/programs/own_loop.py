"""A thread publishes each 30 ms what came last; the executor only listens."""

import threading
import time

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.last = JointState()
        threading.Thread(target=self.run, daemon=True).start()

    def answer(self, message, name=''):
        names = [name + joint for joint in message.name]
        self.publisher.publish(JointState(header=message.header, name=names, velocity=message.position))

    def on_joints(self, message):
        self.last = message

    def run(self):
        while rclpy.ok():
            self.answer(self.last)
            time.sleep(0.03)


rclpy.init()
node = Relay()
rclpy.spin(node)
