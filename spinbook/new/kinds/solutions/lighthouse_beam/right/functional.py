"""Without a class: create_node, a generator of directions and a closure."""

import math
from itertools import count

import rclpy
from geometry_msgs.msg import Vector3, Vector3Stamped
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Header


def directions():
    for i in count():
        angle = 2 * math.pi * i / 20
        yield Vector3(x=math.cos(angle), y=math.sin(angle))


def main():
    rclpy.init()
    node = rclpy.create_node("lighthouse_beam")
    publisher = node.create_publisher(Vector3Stamped, "/beam", 10)
    beam = directions()

    def on_timer():
        header = Header(stamp=node.get_clock().now().to_msg(), frame_id="lighthouse")
        publisher.publish(Vector3Stamped(header=header, vector=next(beam)))

    node.create_timer(0.2, on_timer)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
