"""Rate.sleep() in a node that nothing spins: it waits forever.

Caught by:
- test_publishes_beats
"""

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
    rate = node.create_rate(4)
    try:
        while rclpy.ok():
            rate.sleep()
            node.publisher.publish(Header(stamp=node.get_clock().now().to_msg(), frame_id='torso'))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
