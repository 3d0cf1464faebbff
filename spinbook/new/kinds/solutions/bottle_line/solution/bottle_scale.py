"""The scale of a bottling line: is a bottle full?"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64

LEAST, MOST = 490.0, 510.0  # g


class BottleScale(Node):
    """Hears weights and says of each whether it is right."""

    def __init__(self):
        super().__init__("bottle_scale")
        self.create_subscription(Float64, "/weight", self.on_weight, 10)
        # TODO: create a publisher of Bool messages on "/full", with a queue depth of 10.
        # BEGIN SOLUTION
        self.publisher = self.create_publisher(Bool, "/full", 10)
        # END SOLUTION

    def on_weight(self, message):
        """Called once for each bottle (g)."""
        # TODO: publish whether the weight is right.
        # BEGIN SOLUTION
        self.publisher.publish(Bool(data=LEAST <= message.data <= MOST))
        # END SOLUTION


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
