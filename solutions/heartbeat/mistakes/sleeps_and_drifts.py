"""A timer at 100 Hz beats when 0.25 s have passed since the last beat, and is a little late each time.

Caught by:
- test_four_beats_a_second
"""

import rclpy
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):

    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)
        self.timer = self.create_timer(0.01, self.beat)
        self.last = self.get_clock().now()
        self.get_logger().info('The heart is ready')

    def beat(self):
        now = self.get_clock().now()
        if now - self.last <= Duration(seconds=0.25):
            return
        self.last = now
        message = Header()
        message.stamp = self.get_clock().now().to_msg()
        message.frame_id = 'torso'
        self.publisher.publish(message)


def main():
    rclpy.init()
    node = Heartbeat()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
