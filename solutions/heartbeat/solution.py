"""Publish a heartbeat: a stamp on /heartbeat, four times a second."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):
    """Tells everybody that the torso's computer is alive."""

    def __init__(self):
        super().__init__('heartbeat')
        # TODO: create a publisher of Header messages on '/heartbeat', with a queue depth of 10.
        # TODO: create a timer that calls self.beat four times a second.
        # BEGIN SOLUTION
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)
        self.timer = self.create_timer(0.25, self.beat)
        # END SOLUTION
        self.get_logger().info('The heart is ready')

    def beat(self):
        """Called once for each beat."""
        # TODO: publish a Header with the time of the node's clock and the frame 'torso'.
        # BEGIN SOLUTION
        message = Header()
        message.stamp = self.get_clock().now().to_msg()
        message.frame_id = 'torso'
        self.publisher.publish(message)
        # END SOLUTION


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
