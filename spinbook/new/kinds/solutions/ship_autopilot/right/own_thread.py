"""The callbacks pass on what they receive; a thread of its own steers."""

import cmath
import queue
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class ShipAutopilot(Node):
    def __init__(self):
        super().__init__("ship_autopilot")
        self.course = None
        self.headings = queue.Queue()
        self.publisher = self.create_publisher(Float64, "/rudder", 10)
        self.create_subscription(Float64, "/course", self.on_course, 10)
        self.create_subscription(Float64, "/heading", self.headings.put, 10)
        threading.Thread(target=self.steer, daemon=True).start()

    def on_course(self, message):
        self.course = message.data

    def steer(self):
        while True:
            heading = self.headings.get().data
            rudder = 0.0
            if self.course is not None:
                rudder = cmath.phase(cmath.exp(1j * (self.course - heading)))
            self.publisher.publish(Float64(data=max(-0.6, min(0.6, rudder))))


def main():
    rclpy.init()
    node = ShipAutopilot()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
