"""A second node in the program answers what the first one passes on."""

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.inner = self.create_publisher(JointState, '/inner', 10)

    def answer(self, message, name=''):
        names = [name + joint for joint in message.name]
        self.publisher.publish(JointState(header=message.header, name=names, velocity=message.position))

    def on_joints(self, message):
        self.inner.publish(message)


rclpy.init()
node = Relay()
second = rclpy.create_node('second')
second.create_subscription(JointState, '/inner', node.answer, 10)
executor = SingleThreadedExecutor()
executor.add_node(node)
executor.add_node(second)
executor.spin()
