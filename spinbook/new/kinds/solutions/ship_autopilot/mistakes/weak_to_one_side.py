"""Has a typo in one of the two limits: to the right the rudder hardly moves.

Caught by:
- test_reaches_a_course_to_the_right
"""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

GAIN = 1.0


class ShipAutopilot(Node):
    """Answers each heading with an angle of the rudder."""

    def __init__(self):
        super().__init__("ship_autopilot")
        self.course = None  # rad, once there is one
        self.create_subscription(Float64, "/course", self.on_course, 10)
        self.create_subscription(Float64, "/heading", self.on_heading, 10)
        self.publisher = self.create_publisher(Float64, "/rudder", 10)

    def on_course(self, message):
        """Called when the ship gets a course (rad)."""
        self.course = message.data

    def on_heading(self, message):
        """Called ten times per second with what the compass shows (rad)."""
        rudder = 0.0
        if self.course is not None:
            error = wrapped(self.course - message.data)
            rudder = max(-0.06, min(0.6, GAIN * error))
        self.publisher.publish(Float64(data=rudder))


def wrapped(angle):
    """The same angle (rad) from -pi to pi."""
    return math.atan2(math.sin(angle), math.cos(angle))


def main():
    rclpy.init()
    node = ShipAutopilot()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
