"""Accepts any XML, even without a <robot>.

Caught by:
- test_refuses_what_is_no_robot
- test_publishes_nothing_refused
"""

from xml.etree import ElementTree

import rclpy
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

DEFAULT = '<robot name="humanoid"/>'


class RobotDescription(Node):

    def __init__(self):
        super().__init__('robot_description')
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, '/robot_description', latched)
        description = ParameterDescriptor(description='The robot as URDF: its links and joints.')
        self.declare_parameter('robot_description', DEFAULT, description)
        self.add_on_set_parameters_callback(self.on_set)
        self.add_post_set_parameters_callback(self.on_changed)
        self.published = None
        self.publish(self.get_parameter('robot_description').value)
        self.get_logger().info('The description is there')

    def on_set(self, parameters):
        for parameter in parameters:
            if parameter.name == 'robot_description' and not is_robot(parameter.value):
                return SetParametersResult(successful=False, reason='this is no <robot> in XML')
        return SetParametersResult(successful=True)

    def on_changed(self, parameters):
        for parameter in parameters:
            if parameter.name == 'robot_description':
                self.publish(parameter.value)

    def publish(self, text):
        if text != self.published:
            self.published = text
            self.publisher.publish(String(data=text))



def is_robot(text):
    try:
        return ElementTree.fromstring(text) is not None
    except ElementTree.ParseError:
        return False


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
