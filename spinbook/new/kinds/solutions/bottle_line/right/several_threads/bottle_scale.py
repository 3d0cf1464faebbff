"""A thread of its own weighs."""

import queue
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class BottleScale(Node):
    def __init__(self):
        super().__init__("bottle_scale")
        self.bottles = queue.Queue()
        self.publisher = self.create_publisher(Bool, "/full", 10)
        self.create_subscription(Float64, "/weight", self.bottles.put, 10)
        threading.Thread(target=self.weigh, daemon=True).start()

    def weigh(self):
        while True:
            weight = self.bottles.get().data
            self.publisher.publish(Bool(data=490.0 <= weight <= 510.0))


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
