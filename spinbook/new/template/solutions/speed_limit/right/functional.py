"""Right, without a class: a function and two comparisons."""

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Float64


def safe(speed):
    if speed > 1.0:
        return 1.0
    if speed < -1.0:
        return -1.0
    # Only NaN differs from itself.
    return speed if speed == speed else 0.0


def main():
    rclpy.init()
    node = rclpy.create_node("speed_limit")
    publisher = node.create_publisher(Float64, "/safe_speed", 10)
    node.create_subscription(
        Float64, "/wanted_speed", lambda message: publisher.publish(Float64(data=safe(message.data))), 10
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
