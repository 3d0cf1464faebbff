"""Measures the silence from its own start: the gate closes before the first bottle.

Caught by:
- test_gate_without_a_bottle
- test_either_starts_late
"""

# file: bottle_scale.py
"""The scale of a bottling line: is a bottle full?"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64

LEAST, MOST = 490.0, 510.0  # g


class BottleScale(Node):
    """Receives weights and publishes whether each one is right."""

    def __init__(self):
        super().__init__("bottle_scale")
        self.create_subscription(Float64, "/weight", self.on_weight, 10)
        self.publisher = self.create_publisher(Bool, "/full", 10)

    def on_weight(self, message):
        """Called once for each bottle (g)."""
        self.publisher.publish(Bool(data=LEAST <= message.data <= MOST))


def main():
    rclpy.init()
    node = BottleScale()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()


# file: bottle_sorter.py
"""The sorter of a bottling line: a gate that lets full bottles pass, and closes when the scale is silent."""

import rclpy
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, String

SILENCE = Duration(seconds=2.0)
PERIOD = 0.05  # s, between two looks at the clock


class BottleSorter(Node):
    """Receives what the scale publishes and moves the gate."""

    def __init__(self):
        super().__init__("bottle_sorter")
        self.create_subscription(Bool, "/full", self.on_bottle, 10)
        self.publisher = self.create_publisher(String, "/gate", 10)
        self.last = None  # when the scale was heard last
        self.closed = False
        self.create_timer(PERIOD, self.on_tick)

    def on_bottle(self, message):
        """Called once for each bottle that was weighed."""
        self.last = self.get_clock().now()
        self.closed = False
        self.publisher.publish(String(data="pass" if message.data else "reject"))

    def on_tick(self):
        """Called every PERIOD seconds."""
        now = self.get_clock().now()
        self.last = self.last or now
        if not self.closed and now - self.last >= SILENCE:
            self.closed = True
            self.publisher.publish(String(data="closed"))


def main():
    rclpy.init()
    node = BottleSorter()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
