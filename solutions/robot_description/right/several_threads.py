"""With a MultiThreadedExecutor."""

from xml.etree import ElementTree

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String


class RobotDescription(Node):
    def __init__(self):
        super().__init__('robot_description')
        profile = QoSProfile(depth=1)
        profile.reliability = ReliabilityPolicy.RELIABLE
        profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
        self.publisher = self.create_publisher(String, '/robot_description', profile)
        self.current = self.declare_parameter('robot_description', '<robot name="humanoid"/>').value
        self.add_on_set_parameters_callback(self.accept)
        self.add_post_set_parameters_callback(self.use)
        self.publisher.publish(String(data=self.current))

    def accept(self, parameters):
        reasons = [self.fault_in(p.value) for p in parameters if p.name == 'robot_description']
        return SetParametersResult(successful=not any(reasons), reason=''.join(reasons))

    def fault_in(self, text):
        try:
            tag = ElementTree.fromstring(text).tag
        except ElementTree.ParseError as error:
            return str(error)
        return '' if tag == 'robot' else f'<{tag}> is not <robot>'

    def use(self, parameters):
        for parameter in parameters:
            if parameter.name == 'robot_description' and self.current != parameter.value:
                self.current = parameter.value
                self.publisher.publish(String(data=self.current))


def main():
    rclpy.init()
    node = RobotDescription()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
