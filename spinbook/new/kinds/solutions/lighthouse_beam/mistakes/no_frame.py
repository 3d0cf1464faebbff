"""Forgets the frame.

Caught by:
- test_frame_is_the_lighthouse
"""

import math

import rclpy
from geometry_msgs.msg import Vector3Stamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

PERIOD = 0.2  # s
STEP = math.radians(18.0)  # the beam turns this far from one message to the next


class LighthouseBeam(Node):
    """Publishes with a timer of its own."""

    def __init__(self):
        super().__init__("lighthouse_beam")
        self.get_logger().info("The lamp is lit.")
        self.publisher = self.create_publisher(Vector3Stamped, "/beam", 10)
        self.timer = self.create_timer(PERIOD, self.on_timer)
        self.count = 0

    def on_timer(self):
        """Called every PERIOD seconds."""
        message = Vector3Stamped()
        message.header.stamp = self.get_clock().now().to_msg()
        message.vector.x = math.cos(self.count * STEP)
        message.vector.y = math.sin(self.count * STEP)
        self.publisher.publish(message)
        self.count += 1


def main():
    rclpy.init()
    node = LighthouseBeam()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
