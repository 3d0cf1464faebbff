"""One coroutine for each star: send, await, await, publish."""

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Empty, Float32
from turtlesim.action import RotateAbsolute


class Telescope:
    def __init__(self, node, group):
        self.client = ActionClient(node, RotateAbsolute, "/turn", callback_group=group)
        self.handle = None

    async def turn(self, angle):
        """Whether it pointed to the angle (rad) in the end."""
        handle = await self.client.send_goal_async(RotateAbsolute.Goal(theta=angle))
        if not handle.accepted:
            return False
        self.handle = handle
        answer = await handle.get_result_async()
        self.handle = None
        return answer.status == GoalStatus.STATUS_SUCCEEDED

    def cancel(self):
        if self.handle is not None:
            self.handle.cancel_goal_async()


class NightObserver(Node):
    def __init__(self):
        super().__init__("night_observer")
        group = ReentrantCallbackGroup()
        self.telescope = Telescope(self, group)
        self.stars, self.busy = [], False
        self.photo = self.create_publisher(Float32, "/photo", 10)
        self.missed = self.create_publisher(Float32, "/missed", 10)
        self.create_subscription(Float32, "/star", self.on_star, 10, callback_group=group)
        self.create_subscription(Empty, "/clouds", lambda _: self.telescope.cancel(), 10, callback_group=group)
        self.create_timer(0.5, self.work, callback_group=group)

    async def on_star(self, message):
        self.stars.append(message.data)
        await self.work()

    async def work(self):
        if self.busy:
            return
        self.busy = True
        while self.stars and self.telescope.client.server_is_ready():
            star = self.stars.pop(0)
            publisher = self.photo if await self.telescope.turn(star) else self.missed
            publisher.publish(Float32(data=star))
        self.busy = False


def main():
    rclpy.init()
    node = NightObserver()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
