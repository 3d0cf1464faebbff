"""The executor that callbacks notify of messages."""

import rclpy
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

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
executor = EventsExecutor()
executor.add_node(node)
executor.spin()
