"""Subscribes to coins with the quality of service for sensors: a coin may get lost.

Caught by:
- test_node_is_as_described
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

PRICE = 100  # cents
COINS = (10, 20, 50, 100, 200)  # cents


class CoinTurnstile(Node):
    """Counts coins and answers each push."""

    def __init__(self):
        super().__init__("coin_turnstile")
        self.credit = 0  # cents
        self.subscription = self.create_subscription(Int32, "/coins", self.on_coin, qos_profile_sensor_data)
        self.service = self.create_service(Trigger, "/push", self.on_push)

    def on_coin(self, message):
        """Called once for each coin."""
        if message.data in COINS:
            self.credit += message.data

    def on_push(self, request, response):
        """Called once for each request. What it returns is sent as the response."""
        if self.credit >= PRICE:
            self.credit -= PRICE
            response.success = True
            response.message = "welcome"
        else:
            response.success = False
            response.message = f"{PRICE - self.credit} cents missing"
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
