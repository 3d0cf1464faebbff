# file: bottle_scale.py
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


# file: bottle_sorter.py
"""Several threads; a lock keeps the bottle and the timer apart."""

import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Bool, String


class BottleSorter(Node):
    def __init__(self):
        super().__init__("bottle_sorter")
        group = ReentrantCallbackGroup()
        self.lock = threading.Lock()
        self.publisher = self.create_publisher(String, "/gate", 10)
        self.timer = self.create_timer(2.0, self.on_silence, callback_group=group)
        self.timer.cancel()
        self.create_subscription(Bool, "/full", self.on_bottle, 10, callback_group=group)

    def on_bottle(self, message):
        with self.lock:
            self.timer.reset()
            self.publisher.publish(String(data="pass" if message.data else "reject"))

    def on_silence(self):
        with self.lock:
            self.timer.cancel()
            self.publisher.publish(String(data="closed"))


def main():
    rclpy.init()
    node = BottleSorter()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
