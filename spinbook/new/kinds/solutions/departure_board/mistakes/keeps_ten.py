"""Keeps ten lines instead of one: a late subscriber gets old ones, too.

Caught by:
- test_a_late_passenger_sees_no_older_line
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int32, String


class DepartureBoard(Node):
    """Receives the destination once and delays now and then; shows both in one line."""

    def __init__(self):
        super().__init__("departure_board")
        self.destination = None
        self.delay = 0  # min
        self.create_subscription(Int32, "/delay", self.on_delay, 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(String, "/destination", self.on_destination, latched)
        self.publisher = self.create_publisher(String, "/board", QoSProfile(depth=10, durability=latched.durability))

    def on_destination(self, message):
        """Called when the train gets a destination."""
        self.destination = message.data
        self.show()

    def on_delay(self, message):
        """Called when the delay (min) changes."""
        changed = message.data != self.delay
        self.delay = message.data
        if changed and self.destination is not None:
            self.show()

    def show(self):
        """Publish the board's one line."""
        late = f", {self.delay} min late" if self.delay > 0 else ""
        self.publisher.publish(String(data=f"{self.destination}{late}"))


def main():
    rclpy.init()
    node = DepartureBoard()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
