"""The callback puts each wish into a queue; a thread of its own answers."""

import queue
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class SpeedLimit(Node):
    def __init__(self):
        super().__init__("speed_limit")
        self.wishes = queue.Queue()
        self.publisher = self.create_publisher(Float64, "/safe_speed", 10)
        self.create_subscription(Float64, "/wanted_speed", self.wishes.put, 10)
        threading.Thread(target=self.answer, daemon=True).start()

    def answer(self):
        while True:
            speed = self.wishes.get().data
            safe = sorted([-1.0, speed, 1.0])[1] if speed == speed else 0.0
            self.publisher.publish(Float64(data=safe))


def main():
    rclpy.init()
    node = SpeedLimit()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
