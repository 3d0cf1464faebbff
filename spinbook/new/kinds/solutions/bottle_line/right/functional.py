# file: bottle_scale.py
"""Without a class: create_node and a closure."""

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Bool, Float64


def main():
    rclpy.init()
    node = rclpy.create_node("bottle_scale")
    publisher = node.create_publisher(Bool, "full", 10)
    node.create_subscription(
        Float64, "weight", lambda message: publisher.publish(Bool(data=abs(message.data - 500.0) <= 10.0)), 10
    )
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
"""Without a class: closures."""

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Bool, String


def main():
    rclpy.init()
    node = rclpy.create_node("bottle_sorter")
    publisher = node.create_publisher(String, "gate", 10)

    def on_silence():
        timer.cancel()
        publisher.publish(String(data="closed"))

    def on_bottle(message):
        timer.reset()
        publisher.publish(String(data=("reject", "pass")[message.data]))

    timer = node.create_timer(2.0, on_silence)
    timer.cancel()
    node.create_subscription(Bool, "full", on_bottle, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
