"""Calls without checking whether the sprinkler is there: the request is lost.

Caught by:
- test_a_sprinkler_that_appears_late
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool

LIMIT = 0.3  # more smoke than this is a fire
PERIOD = 0.2  # s


class FireWatch(Node):
    """Asks the sprinkler to go on or off, and never waits for its answer."""

    def __init__(self):
        super().__init__("fire_watch")
        self.fire = False  # is there a fire?
        self.asked = False  # what the sprinkler was asked last: on or off
        self.create_subscription(Float64, "/smoke", self.on_smoke, 10)
        self.client = self.create_client(SetBool, "/sprinkler")
        self.siren = self.create_publisher(Bool, "/siren", 10)
        self.report = self.create_publisher(String, "/report", 10)
        self.create_timer(PERIOD, self.on_timer)

    def on_smoke(self, message):
        """Called once for each message on /smoke."""
        self.fire = message.data > LIMIT
        self.ask()

    def on_timer(self):
        """Called every PERIOD seconds."""
        self.siren.publish(Bool(data=self.fire))
        self.ask()

    def ask(self):
        """Ask the sprinkler for a change, if one is due and the sprinkler is there."""
        if self.fire != self.asked:
            self.asked = wanted = self.fire
            future = self.client.call_async(SetBool.Request(data=wanted))
            future.add_done_callback(lambda done: self.on_response(wanted, done.result()))

    def on_response(self, wanted, response):
        """Called once for each response of the sprinkler."""
        text = f"sprinkler {'on' if wanted else 'off'}" if response.success else f"failed: {response.message}"
        self.report.publish(String(data=text))


def main():
    rclpy.init()
    node = FireWatch()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
