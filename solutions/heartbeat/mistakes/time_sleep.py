"""A loop with time.sleep() instead of a timer.

Caught by:
- test_four_beats_a_second
- test_stamp_is_the_time_of_the_beat
"""

import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):
    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)


def main():
    rclpy.init()
    node = Heartbeat()
    try:
        while rclpy.ok():
            time.sleep(0.25)
            rclpy.spin_once(node, timeout_sec=0.0)
            node.publisher.publish(Header(stamp=node.get_clock().now().to_msg(), frame_id='torso'))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
