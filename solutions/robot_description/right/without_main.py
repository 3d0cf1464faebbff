"""Without a main function; the default and the check are at the top."""

import xml.sax

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class Outermost(xml.sax.ContentHandler):
    name = None

    def startElement(self, name, attrs):  # noqa: N802
        self.name = self.name or name


def outermost(text):
    handler = Outermost()
    try:
        xml.sax.parseString(text.encode(), handler)
    except xml.sax.SAXException:
        return None
    return handler.name


class RobotDescription(Node):
    def __init__(self):
        Node.__init__(self, 'robot_description')
        self.declare_parameter('robot_description', '<robot name="humanoid"/>')
        self.pub = self.create_publisher(
            String, '/robot_description', QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        )
        self.add_on_set_parameters_callback(self.on_set)
        self.add_post_set_parameters_callback(self.post_set)
        self.old = ''
        self.post_set([self.get_parameter('robot_description')])

    def on_set(self, params):
        for param in params:
            if param.name == 'robot_description' and outermost(param.value) != 'robot':
                return SetParametersResult(successful=False, reason='no robot')
        return SetParametersResult(successful=True)

    def post_set(self, params):
        for param in params:
            if param.name == 'robot_description' and param.value != self.old:
                self.old = param.value
                self.pub.publish(String(data=param.value))


rclpy.init()
node = RobotDescription()
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
rclpy.try_shutdown()
