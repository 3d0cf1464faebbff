"""With a MultiThreadedExecutor and a callback group of its own."""

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):
    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)
        self.timer = self.create_timer(0.25, self.beat, callback_group=MutuallyExclusiveCallbackGroup())

    def beat(self):
        now = self.get_clock().now()
        seconds, nanoseconds = now.seconds_nanoseconds()
        message = Header()
        message.stamp.sec = seconds
        message.stamp.nanosec = nanoseconds
        message.frame_id = 'torso'
        self.publisher.publish(message)


def main():
    rclpy.init()
    node = Heartbeat()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
