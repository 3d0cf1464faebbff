"""A thread of its own waits on the node's clock and publishes; the main thread spins."""

import math
import threading

import rclpy
from geometry_msgs.msg import Vector3Stamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class LighthouseBeam(Node):
    def __init__(self):
        super().__init__("lighthouse_beam")
        self.publisher = self.create_publisher(Vector3Stamped, "/beam", 10)
        self.rate = self.create_rate(5.0)
        threading.Thread(target=self.shine, daemon=True).start()

    def shine(self):
        angle = 0.0
        try:
            while rclpy.ok():
                self.rate.sleep()
                message = Vector3Stamped()
                message.header.stamp = self.get_clock().now().to_msg()
                message.header.frame_id = "lighthouse"
                message.vector.x, message.vector.y = math.cos(angle), math.sin(angle)
                self.publisher.publish(message)
                angle += math.radians(18)
        except Exception:
            if rclpy.ok():
                raise


def main():
    rclpy.init()
    node = LighthouseBeam()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
