"""A timer of a clock that does not follow /clock publishes each 70 ms what came last."""

import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.last = JointState()
        self.create_timer(0.07, lambda: self.answer(self.last), clock=Clock(clock_type=ClockType.STEADY_TIME))

    def answer(self, message, name=''):
        names = [name + joint for joint in message.name]
        self.publisher.publish(JointState(header=message.header, name=names, velocity=message.position))

    def on_joints(self, message):
        self.last = message


rclpy.init()
node = Relay()
rclpy.spin(node)
