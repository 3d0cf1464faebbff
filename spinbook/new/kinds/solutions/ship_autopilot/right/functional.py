"""Without a class; the difference is wrapped by a remainder."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Float64


def rudder(course, heading):
    difference = math.remainder(course - heading, 2 * math.pi)
    return min(max(0.9 * difference, -0.6), 0.6)


def main():
    rclpy.init()
    node = rclpy.create_node("ship_autopilot")
    publisher = node.create_publisher(Float64, "rudder", 10)
    courses = []

    def on_heading(message):
        angle = rudder(courses[-1], message.data) if courses else 0.0
        publisher.publish(Float64(data=angle))

    node.create_subscription(Float64, "course", lambda message: courses.append(message.data), 10)
    node.create_subscription(Float64, "heading", on_heading, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
