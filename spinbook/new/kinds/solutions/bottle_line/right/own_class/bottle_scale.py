"""The range of a full bottle is a class of its own."""

from dataclasses import dataclass

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


@dataclass(frozen=True)
class Range:
    least: float
    most: float

    def __contains__(self, weight):
        return self.least <= weight <= self.most


class BottleScale(Node):
    def __init__(self):
        super().__init__("bottle_scale")
        self.full = Range(490.0, 510.0)
        self.publisher = self.create_publisher(Bool, "/full", 10)
        self.create_subscription(Float64, "/weight", self.weigh, 10)

    def weigh(self, message):
        self.publisher.publish(Bool(data=message.data in self.full))


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
