"""Starts a second node that listens for any publisher of velocities, and publishes them as its own."""

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity')
        self.create_subscription(JointState, '/joint_commands', self.look_around, 10)
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.listening = set()

    def look_around(self, message):
        for topic, types in self.get_topic_names_and_types():
            if 'sensor_msgs/msg/JointState' in types and topic != '/joint_commands' and topic not in self.listening:
                self.listening.add(topic)
                self.create_subscription(JointState, topic, self.copy, 10)

    def copy(self, message):
        if message.velocity and message.header.frame_id != 'copied':
            message.header.frame_id = 'copied'
            self.publisher.publish(message)


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(JointVelocity())
    executor.add_node(Node('joint_state_monitor'))
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
