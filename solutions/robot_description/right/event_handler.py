"""Learns of the change from a parameter event."""

from xml.dom import minidom
from xml.parsers.expat import ExpatError

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter_event_handler import ParameterEventHandler
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

NAME = 'robot_description'


class RobotDescription(Node):
    def __init__(self):
        super().__init__(NAME)
        qos = QoSProfile(
            depth=1,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
            history=HistoryPolicy.KEEP_LAST,
            reliability=ReliabilityPolicy.RELIABLE,
        )
        self.publisher = self.create_publisher(String, NAME, qos)
        self.text = self.declare_parameter(NAME, '<robot name="humanoid"/>').value
        self.publisher.publish(String(data=self.text))
        self.add_on_set_parameters_callback(self.check)
        self.handler = ParameterEventHandler(self)
        self.watched = self.handler.add_parameter_callback(NAME, self.get_fully_qualified_name(), self.changed)

    def check(self, parameters):
        result = SetParametersResult(successful=True)
        for parameter in parameters:
            if parameter.name == NAME:
                try:
                    root = minidom.parseString(parameter.value.encode()).documentElement
                    result.successful = root.tagName == 'robot'
                    result.reason = '' if result.successful else f'<{root.tagName}> is not <robot>'
                except ExpatError as error:
                    result.successful = False
                    result.reason = str(error)
        return result

    def changed(self, parameter):
        text = parameter.value.string_value
        if text != self.text:
            self.text = text
            self.publisher.publish(String(data=text))


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
