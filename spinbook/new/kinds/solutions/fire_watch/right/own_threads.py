"""Threads: the call waits for its response in a thread of its own, and all other callbacks continue."""

import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool


class FireWatch(Node):
    def __init__(self):
        super().__init__("fire_watch")
        self.fire = self.asked = False
        self.siren = self.create_publisher(Bool, "/siren", 10)
        self.report = self.create_publisher(String, "/report", 10)
        self.client = self.create_client(SetBool, "/sprinkler")
        self.create_subscription(Float64, "/smoke", self.on_smoke, 10)
        self.create_timer(0.2, self.on_timer)

    def on_smoke(self, message):
        self.fire = message.data > 0.3
        self.ask()

    def on_timer(self):
        self.siren.publish(Bool(data=self.fire))
        self.ask()

    def ask(self):
        if self.fire != self.asked and self.client.service_is_ready():
            self.asked = self.fire
            threading.Thread(target=self.call, args=[self.asked], daemon=True).start()

    def call(self, wanted):
        response = self.client.call(SetBool.Request(data=wanted))
        word = "on" if wanted else "off"
        self.report.publish(String(data=f"sprinkler {word}" if response.success else f"failed: {response.message}"))


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
