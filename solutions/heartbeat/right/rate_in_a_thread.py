"""A Rate in a thread of its own, while the main thread spins."""

import threading

import rclpy
from rclpy.exceptions import ROSInterruptException
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):
    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)
        self.rate = self.create_rate(4.0)
        threading.Thread(target=self.beats, daemon=True).start()

    def beats(self):
        try:
            while rclpy.ok():
                self.rate.sleep()
                self.publisher.publish(Header(stamp=self.get_clock().now().to_msg(), frame_id='torso'))
        except ROSInterruptException:
            pass


def main():
    rclpy.init()
    node = Heartbeat()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
