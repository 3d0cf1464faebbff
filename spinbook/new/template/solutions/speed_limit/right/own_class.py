"""The limit is a class of its own that knows nothing about ROS."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Float64


class Limit:
    def __init__(self, greatest):
        self.greatest = greatest

    def __call__(self, speed):
        if math.isnan(speed):
            return 0.0
        if abs(speed) <= self.greatest:
            return speed
        return math.copysign(self.greatest, speed)


class SpeedLimit(Node):
    def __init__(self):
        super().__init__("speed_limit")
        self.limit = Limit(1.0)
        self.publisher = self.create_publisher(Float64, "safe_speed", QoSProfile(depth=10))
        self.create_subscription(Float64, "wanted_speed", self.on_speed, QoSProfile(depth=10))

    def on_speed(self, message):
        message.data = self.limit(message.data)
        self.publisher.publish(message)


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
