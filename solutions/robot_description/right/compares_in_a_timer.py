"""Accepts in the on-set callback, and publishes from a timer that sees the change 50 ms later at most."""

from xml.etree.ElementTree import ParseError, fromstring

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class RobotDescription(Node):
    def __init__(self):
        super().__init__('robot_description')
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, '/robot_description', latched)
        self.declare_parameter('robot_description', '<robot name="humanoid"/>')
        self.add_on_set_parameters_callback(self.on_set)
        self.told = None
        self.tell()
        self.create_timer(0.05, self.tell)

    def tell(self):
        text = self.get_parameter('robot_description').value
        if text != self.told:
            self.publisher.publish(String(data=text))
            self.told = text

    def on_set(self, parameters):
        for parameter in parameters:
            if parameter.name != 'robot_description':
                continue
            try:
                if fromstring(parameter.value).tag != 'robot':
                    return SetParametersResult(successful=False, reason='the outermost element is not <robot>')
            except ParseError as error:
                return SetParametersResult(successful=False, reason=f'not XML: {error}')
        return SetParametersResult(successful=True)


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
