"""Without a class: two functions and a list with the credit in it."""

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Int32
from std_srvs.srv import Trigger


def pushed(credit):
    """The response to a push, and the credit after it."""
    if credit < 100:
        return Trigger.Response(message=f"{100 - credit} cents missing"), credit
    return Trigger.Response(success=True, message="welcome"), credit - 100


def main():
    rclpy.init()
    node = rclpy.create_node("coin_turnstile")
    credit = [0]

    def on_coin(message):
        credit[0] += message.data if message.data in {10, 20, 50, 100, 200} else 0

    def on_push(_, __):
        response, credit[0] = pushed(credit[0])
        return response

    node.create_subscription(Int32, "coins", on_coin, 10)
    node.create_service(Trigger, "push", on_push)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
