"""The lamp is a class that knows nothing about ROS: it turns a vector, step by step."""

import cmath
import math

import rclpy
from geometry_msgs.msg import Vector3Stamped
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class Lamp:
    def __init__(self, step):
        self.turn = cmath.exp(1j * step)
        self.beam = 1 + 0j

    def next(self):
        beam = self.beam
        self.beam *= self.turn
        return beam.real, beam.imag


class LighthouseBeam:
    def __init__(self, node):
        self.node = node
        self.lamp = Lamp(math.pi / 10)
        self.publisher = node.create_publisher(Vector3Stamped, "beam", 10)
        node.create_timer(1 / 5, self.show)

    def show(self):
        message = Vector3Stamped()
        message.header.frame_id = "lighthouse"
        message.header.stamp = self.node.get_clock().now().to_msg()
        message.vector.x, message.vector.y = self.lamp.next()
        self.publisher.publish(message)


def main():
    rclpy.init()
    node = Node("lighthouse_beam")
    LighthouseBeam(node)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
