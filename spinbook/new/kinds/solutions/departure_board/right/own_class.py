"""A train knows its line; the node publishes it when it has changed or the destination was announced."""

from dataclasses import dataclass

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int32, String


@dataclass
class Train:
    destination: str = ""
    announced: bool = False
    delay: int = 0

    def line(self):
        return self.destination if self.delay <= 0 else f"{self.destination}, {self.delay} min late"


class DepartureBoard(Node):
    def __init__(self):
        super().__init__("departure_board")
        self.train = Train()
        qos = QoSProfile(depth=1)
        qos.durability = DurabilityPolicy.TRANSIENT_LOCAL
        self.board = self.create_publisher(String, "/board", qos)
        self.create_subscription(String, "/destination", self.announce, qos)
        self.create_subscription(Int32, "/delay", self.delayed, 10)

    def announce(self, message):
        self.train.destination, self.train.announced = message.data, True
        self.board.publish(String(data=self.train.line()))

    def delayed(self, message):
        if message.data == self.train.delay:
            return
        self.train.delay = message.data
        if self.train.announced:
            self.board.publish(String(data=self.train.line()))


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
