"""Rounds to whole metres per second.

Caught by:
- test_safe_speeds_pass
- test_too_fast_is_slowed_down
- test_too_fast_backwards
- test_not_a_number
"""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

LIMIT = 1.0  # m/s


class SpeedLimit(Node):
    """Answers each wanted speed with a safe speed."""

    def __init__(self):
        super().__init__("speed_limit")
        self.subscription = self.create_subscription(Float64, "/wanted_speed", self.on_speed, 10)
        self.publisher = self.create_publisher(Float64, "/safe_speed", 10)

    def on_speed(self, message):
        """Called once for each message on /wanted_speed."""
        self.get_logger().info(f"{message.data:.2f} m/s is wanted", throttle_duration_sec=1.0)
        speed = 0.0 if math.isnan(message.data) else float(round(max(-LIMIT, min(LIMIT, message.data))))
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
