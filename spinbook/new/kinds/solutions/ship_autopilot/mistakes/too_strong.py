"""Has a gain that is too large: the ship swings back and forth.

Caught by:
- test_does_not_overshoot
- test_turns_the_short_way_round
- test_half_a_turn
- test_a_course_beyond_two_pi
"""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

GAIN = 6.0
LIMIT = 0.6  # rad, how far the rudder goes to either side


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
            rudder = max(-LIMIT, min(LIMIT, GAIN * error))
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
