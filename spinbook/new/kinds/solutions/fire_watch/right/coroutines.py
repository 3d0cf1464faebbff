"""Coroutines that await the response, in a group of their own in which callbacks may overlap."""

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool


class Sprinkler:
    """Knows what it was asked, and gives the text of the answer."""

    def __init__(self, node, group):
        self.client = node.create_client(SetBool, "/sprinkler", callback_group=group)
        self.asked = False

    async def ask(self, wanted):
        if wanted == self.asked or not self.client.service_is_ready():
            return None
        self.asked = wanted
        response = await self.client.call_async(SetBool.Request(data=wanted))
        if response.success:
            return f"sprinkler {'on' if wanted else 'off'}"
        return f"failed: {response.message}"


class FireWatch(Node):
    def __init__(self):
        super().__init__("fire_watch")
        self.group = ReentrantCallbackGroup()
        self.sprinkler = Sprinkler(self, self.group)
        self.fire = False
        self.siren = self.create_publisher(Bool, "/siren", 10)
        self.report = self.create_publisher(String, "/report", 10)
        self.create_subscription(Float64, "/smoke", self.on_smoke, 10, callback_group=self.group)
        self.create_timer(0.2, self.on_timer, callback_group=self.group)

    async def on_smoke(self, message):
        self.fire = message.data > 0.3
        await self.ask()

    async def on_timer(self):
        self.siren.publish(Bool(data=self.fire))
        await self.ask()

    async def ask(self):
        text = await self.sprinkler.ask(self.fire)
        if text is not None:
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
