"""Without a class: create_node and closures."""

import xml.etree.ElementTree as ET

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from std_msgs.msg import String


def good(text):
    try:
        return ET.fromstring(text).tag == 'robot'
    except ET.ParseError:
        return False


def main():
    rclpy.init()
    node = rclpy.create_node('robot_description')
    qos = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
    publisher = node.create_publisher(String, '/robot_description', qos)
    last = [node.declare_parameter('robot_description', '<robot name="humanoid"/>').value]
    publisher.publish(String(data=last[0]))

    def before(parameters):
        if all(good(p.value) for p in parameters if p.name == 'robot_description'):
            return SetParametersResult(successful=True)
        return SetParametersResult(successful=False, reason='not a robot')

    def after(parameters):
        for p in parameters:
            if p.name == 'robot_description' and p.value != last[0]:
                last[0] = p.value
                publisher.publish(String(data=p.value))

    node.add_on_set_parameters_callback(before)
    node.add_post_set_parameters_callback(after)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
