"""The callbacks put what they receive into a queue; a thread of its own writes the board."""

import queue
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int32, String

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class DepartureBoard(Node):
    def __init__(self):
        super().__init__("departure_board")
        self.news = queue.Queue()
        self.publisher = self.create_publisher(String, "/board", LATCHED)
        self.create_subscription(String, "/destination", lambda text: self.news.put(text.data), LATCHED)
        self.create_subscription(Int32, "/delay", lambda delay: self.news.put(delay.data), 10)
        threading.Thread(target=self.write, daemon=True).start()

    def write(self):
        destination, delay = None, 0
        while True:
            item = self.news.get()
            if isinstance(item, str):
                destination = item
            elif item == delay:
                continue
            else:
                delay = item
            if destination is not None:
                self.publisher.publish(String(data=destination + (f", {delay} min late" if delay > 0 else "")))


def main():
    rclpy.init()
    node = DepartureBoard()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
