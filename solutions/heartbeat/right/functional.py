"""Without a class: create_node and a closure."""

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Header


def main():
    rclpy.init()
    node = rclpy.create_node('heartbeat')
    publisher = node.create_publisher(Header, '/heartbeat', 10)
    node.create_timer(1 / 4, lambda: publisher.publish(Header(stamp=node.get_clock().now().to_msg(), frame_id='torso')))
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
