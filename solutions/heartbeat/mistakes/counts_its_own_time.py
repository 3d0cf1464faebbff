"""The stamp is counted from zero, 0.25 s for each beat.

Caught by:
- test_stamp_is_the_time_of_the_beat
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):

    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)
        self.count = 0
        self.timer = self.create_timer(0.25, self.beat)
        self.get_logger().info('The heart is ready')

    def beat(self):
        message = Header()
        self.count += 1
        message.stamp.sec, quarters = divmod(self.count, 4)
        message.stamp.nanosec = quarters * 250_000_000
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
