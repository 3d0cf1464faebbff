"""A controller of its own, which also looks at how fast the ship turns."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class Controller:
    def __init__(self, p, d, limit):
        self.p, self.d, self.limit = p, d, limit
        self.course = self.before = None

    def __call__(self, heading):
        rate = 0.0 if self.before is None else wrap(heading - self.before) / 0.1
        self.before = heading
        if self.course is None:
            return 0.0
        rudder = self.p * wrap(self.course - heading) - self.d * rate
        return max(-self.limit, min(self.limit, rudder))


def wrap(angle):
    return (angle + math.pi) % (2 * math.pi) - math.pi


class ShipAutopilot(Node):
    def __init__(self):
        super().__init__("ship_autopilot")
        self.controller = Controller(p=1.2, d=0.2, limit=0.6)
        self.publisher = self.create_publisher(Float64, "/rudder", 10)
        self.create_subscription(Float64, "/course", self.on_course, 10)
        self.create_subscription(Float64, "/heading", self.on_heading, 10)

    def on_course(self, message):
        self.controller.course = message.data

    def on_heading(self, message):
        self.publisher.publish(Float64(data=self.controller(message.data)))


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
