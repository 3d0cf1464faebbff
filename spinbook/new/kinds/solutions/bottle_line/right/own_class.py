# file: bottle_scale.py
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


# file: bottle_sorter.py
"""A gate of its own; a new timer for each bottle."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, String


class Gate:
    def __init__(self, node):
        self.publisher = node.create_publisher(String, "/gate", 10)

    def move(self, to):
        self.publisher.publish(String(data=to))


class BottleSorter(Node):
    def __init__(self):
        super().__init__("bottle_sorter")
        self.gate = Gate(self)
        self.timer = None
        self.create_subscription(Bool, "/full", self.sort, 10)

    def wait(self):
        if self.timer is not None:
            self.destroy_timer(self.timer)
        self.timer = self.create_timer(2.0, self.close)

    def sort(self, message):
        self.wait()
        self.gate.move("pass" if message.data else "reject")

    def close(self):
        self.timer.cancel()
        self.gate.move("closed")


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
