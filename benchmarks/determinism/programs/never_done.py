"""Has always something to do, in three ways and in several threads: its time goes on all the same."""

import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.create_timer(0.0, lambda: None)
        self.guard = self.create_guard_condition(lambda: self.guard.trigger())
        self.guard.trigger()

    def on_joints(self, message):
        self.publisher.publish(JointState(header=message.header, name=message.name, velocity=message.position))


def turn():
    executor.create_task(turn)


rclpy.init()
executor = MultiThreadedExecutor(4)
executor.add_node(Relay())
turn()
executor.spin()
