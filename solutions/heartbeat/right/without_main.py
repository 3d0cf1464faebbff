"""Without a main function, and with a loop of its own around spin_once."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Header


class Heartbeat(Node):
    header = Header(frame_id='torso')

    def __init__(self):
        Node.__init__(self, 'heartbeat')
        qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
        self.pub = self.create_publisher(Header, '/heartbeat', qos)
        self.timer = self.create_timer(timer_period_sec=0.25, callback=self.callback)

    def callback(self):
        self.header.stamp = self.get_clock().now().to_msg()
        self.pub.publish(self.header)


rclpy.init()
node = Heartbeat()
try:
    while rclpy.ok():
        rclpy.spin_once(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
rclpy.try_shutdown()
