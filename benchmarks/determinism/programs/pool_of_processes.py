"""Other processes compute what each message is answered with; Python looks into their pipes again and again."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.pool = ProcessPoolExecutor(2, mp_context=multiprocessing.get_context('fork'))

    def on_joints(self, message):
        velocities = list(self.pool.map(float, message.position))
        self.publisher.publish(JointState(header=message.header, name=message.name, velocity=velocities))


rclpy.init()
node = Relay()
rclpy.spin(node)
