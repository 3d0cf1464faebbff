"""Limits the speed forwards, but not backwards.

Caught by:
- test_too_fast_backwards
"""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class SpeedLimit(Node):
    def __init__(self):
        super().__init__("speed_limit")
        self.publisher = self.create_publisher(Float64, "/safe_speed", 10)
        self.create_subscription(Float64, "/wanted_speed", self.on_speed, 10)

    def on_speed(self, message):
        speed = 0.0 if math.isnan(message.data) else min(1.0, message.data)
        self.publisher.publish(Float64(data=speed))


def main():
    rclpy.init()
    node = SpeedLimit()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
