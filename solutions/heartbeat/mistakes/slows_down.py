"""After ten seconds the heart beats a little more slowly.

Caught by:
- test_does_not_drift
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):

    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)
        self.beats = 0
        self.timer = self.create_timer(0.25, self.beat)
        self.get_logger().info('The heart is ready')

    def beat(self):
        self.beats += 1
        if self.beats == 40:
            self.timer.timer_period_ns = 260_000_000
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
