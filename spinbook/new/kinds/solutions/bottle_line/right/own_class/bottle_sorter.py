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
