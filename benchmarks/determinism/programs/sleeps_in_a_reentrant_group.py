"""Two callbacks in reentrant groups, on four threads; one sleeps for 20 ms."""

import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        for name, wait in (('slow ', 0.02), ('quick ', 0.0)):
            self.create_subscription(
                JointState,
                '/joint_commands',
                lambda message, name=name, wait=wait: self.later(message, name, wait),
                10,
                callback_group=ReentrantCallbackGroup(),
            )

    def answer(self, message, name=''):
        names = [name + joint for joint in message.name]
        self.publisher.publish(JointState(header=message.header, name=names, velocity=message.position))

    def later(self, message, name, wait):
        time.sleep(wait)
        self.answer(message, name)


rclpy.init()
node = Relay()
executor = MultiThreadedExecutor(4)
executor.add_node(node)
executor.spin()
