"""The till is a class of its own that knows nothing about ROS."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger


class Till:
    def __init__(self, price):
        self.price, self.credit = price, 0

    def insert(self, cents):
        if cents in (10, 20, 50, 100, 200):
            self.credit += cents

    @property
    def missing(self):
        return max(0, self.price - self.credit)

    def pay(self):
        if self.missing:
            return False
        self.credit -= self.price
        return True


class CoinTurnstile(Node):
    def __init__(self):
        super().__init__("coin_turnstile")
        self.till = Till(100)
        self.create_subscription(Int32, "/coins", lambda coin: self.till.insert(coin.data), 10)
        self.create_service(Trigger, "/push", self.push)

    def push(self, _, response):
        missing = self.till.missing
        response.success = self.till.pay()
        response.message = "welcome" if response.success else f"{missing} cents missing"
        return response


def main():
    rclpy.init()
    node = CoinTurnstile()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
