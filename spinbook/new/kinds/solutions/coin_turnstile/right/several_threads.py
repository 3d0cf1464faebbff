"""Coins and pushes are handled by several threads; a lock guards the credit."""

import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger


class CoinTurnstile(Node):
    def __init__(self):
        super().__init__("coin_turnstile")
        self.lock = threading.Lock()
        self.credit = 0
        group = ReentrantCallbackGroup()
        self.create_subscription(Int32, "/coins", self.on_coin, 10, callback_group=group)
        self.create_service(Trigger, "/push", self.on_push, callback_group=group)

    def on_coin(self, message):
        if message.data in (10, 20, 50, 100, 200):
            with self.lock:
                self.credit += message.data

    async def on_push(self, _, response):
        with self.lock:
            response.success = self.credit >= 100
            if response.success:
                self.credit -= 100
            missing = 100 - self.credit
        response.message = "welcome" if response.success else f"{missing} cents missing"
        return response


def main():
    rclpy.init()
    node = CoinTurnstile()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
