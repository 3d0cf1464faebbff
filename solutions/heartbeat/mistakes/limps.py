"""Every other beat comes 0.05 s early: the heart limps.

Caught by:
- test_each_beat_comes_in_time
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):

    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)
        self.ticks = 0
        self.timer = self.create_timer(0.05, self.tick)
        self.get_logger().info('The heart is ready')

    def tick(self):
        self.ticks += 1
        if self.ticks % 10 in (4, 0):
            self.beat()

    def beat(self):
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
