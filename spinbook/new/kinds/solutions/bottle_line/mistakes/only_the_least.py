"""Never checks whether a bottle is too heavy.

Caught by:
- test_scale_says_which_bottles_are_full
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
        self.publisher.publish(Bool(data=LEAST <= message.data))


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
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, String

SILENCE = 2.0  # s


class BottleSorter(Node):
    """Receives what the scale publishes and moves the gate."""

    def __init__(self):
        super().__init__("bottle_sorter")
        self.create_subscription(Bool, "/full", self.on_bottle, 10)
        self.publisher = self.create_publisher(String, "/gate", 10)
        self.timer = self.create_timer(SILENCE, self.on_silence)
        self.timer.cancel()

    def on_bottle(self, message):
        """Called once for each bottle that was weighed."""
        self.timer.reset()
        self.publisher.publish(String(data="pass" if message.data else "reject"))

    def on_silence(self):
        """Called when nothing has arrived for SILENCE seconds."""
        self.timer.cancel()
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
