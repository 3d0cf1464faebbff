"""A turnstile: coins in, a push, and somebody gets through or not."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

PRICE = 100  # cents
COINS = (10, 20, 50, 100, 200)  # cents


class CoinTurnstile(Node):
    """Counts coins and answers each push."""

    def __init__(self):
        super().__init__("coin_turnstile")
        self.credit = 0  # cents
        self.subscription = self.create_subscription(Int32, "/coins", self.on_coin, 10)
        # TODO: create a service of the type Trigger with the name "/push" that calls self.on_push.
        # BEGIN SOLUTION
        self.service = self.create_service(Trigger, "/push", self.on_push)
        # END SOLUTION

    def on_coin(self, message):
        """Called once for each coin."""
        # TODO: add a coin that there is to the credit.
        # BEGIN SOLUTION
        if message.data in COINS:
            self.credit += message.data
        # END SOLUTION

    def on_push(self, request, response):
        """Called once for each request. What it returns is sent as the response."""
        # TODO: fill in response.success and response.message, and return the response.
        # BEGIN SOLUTION
        if self.credit >= PRICE:
            self.credit -= PRICE
            response.success = True
            response.message = "welcome"
        else:
            response.success = False
            response.message = f"{PRICE - self.credit} cents missing"
        return response
        # END SOLUTION


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
