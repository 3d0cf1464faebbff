"""Publish the robot's description for everybody who asks, now or later."""

from xml.etree import ElementTree

import rclpy
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

DEFAULT = '<robot name="humanoid"/>'


class RobotDescription(Node):
    """Keeps the description as a parameter, and publishes each one once."""

    def __init__(self):
        super().__init__('robot_description')
        # TODO: create a publisher of String messages on '/robot_description' that keeps its last message for late
        #       subscribers: a depth of 1, transient local.
        # TODO: declare the parameter 'robot_description', and publish what it says.
        # TODO: refuse a text that is not a description, and publish a new description when it was set.
        # BEGIN SOLUTION
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, '/robot_description', latched)
        description = ParameterDescriptor(description='The robot as URDF: its links and joints.')
        self.declare_parameter('robot_description', DEFAULT, description)
        self.add_on_set_parameters_callback(self.on_set)
        self.add_post_set_parameters_callback(self.on_changed)
        self.published = None
        self.publish(self.get_parameter('robot_description').value)
        # END SOLUTION
        self.get_logger().info('The description is there')

    # BEGIN SOLUTION
    def on_set(self, parameters):
        """Called before parameters change. Returns whether they may."""
        for parameter in parameters:
            if parameter.name == 'robot_description' and not is_robot(parameter.value):
                return SetParametersResult(successful=False, reason='this is no <robot> in XML')
        return SetParametersResult(successful=True)

    def on_changed(self, parameters):
        """Called after parameters have changed."""
        for parameter in parameters:
            if parameter.name == 'robot_description':
                self.publish(parameter.value)

    def publish(self, text):
        """Publish a description, unless it is the one that was published last."""
        if text != self.published:
            self.published = text
            self.publisher.publish(String(data=text))

    # END SOLUTION


# BEGIN SOLUTION
def is_robot(text):
    """Whether a text is XML whose outermost element is <robot>."""
    try:
        return ElementTree.fromstring(text).tag == 'robot'
    except ElementTree.ParseError:
        return False


# END SOLUTION
def main():
    rclpy.init()
    node = RobotDescription()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
