"""The publisher is transient local: it keeps its last message for those who join late."""

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(JointState, '/joint_velocities', kept)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)

    def answer(self, message, name=''):
        names = [name + joint for joint in message.name]
        self.publisher.publish(JointState(header=message.header, name=names, velocity=message.position))

    def on_joints(self, message):
        self.answer(message)


rclpy.init()
node = Relay()
rclpy.spin(node)
