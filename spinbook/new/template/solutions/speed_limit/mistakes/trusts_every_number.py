"""Never checks whether the speed is a number.

Caught by:
- test_not_a_number
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class SpeedLimit(Node):
    def __init__(self):
        super().__init__("speed_limit")
        self.publisher = self.create_publisher(Float64, "/safe_speed", 10)
        self.create_subscription(Float64, "/wanted_speed", self.on_speed, 10)

    def on_speed(self, message):
        speed = max(-1.0, min(message.data, 1.0))
        self.publisher.publish(Float64(data=speed))


def main():
    rclpy.init()
    node = SpeedLimit()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
