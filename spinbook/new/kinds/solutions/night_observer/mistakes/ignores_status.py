"""Treats every result as a success.

Caught by:
- test_a_goal_that_is_aborted
- test_clouds_cancel_the_goal
"""

from collections import deque

import rclpy
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Empty, Float32
from turtlesim.action import RotateAbsolute

PERIOD = 0.5  # s


class NightObserver(Node):
    """Sends one goal at a time. The next one waits until that one is done."""

    def __init__(self):
        super().__init__("night_observer")
        self.stars = deque()  # rad, those that wait
        self.busy = False  # is there a goal that is not done?
        self.goal_handle = None  # of the goal that was accepted and is not done
        self.create_subscription(Float32, "/star", self.on_star, 10)
        self.create_subscription(Empty, "/clouds", self.on_clouds, 10)
        self.photo = self.create_publisher(Float32, "/photo", 10)
        self.missed = self.create_publisher(Float32, "/missed", 10)
        self.client = ActionClient(self, RotateAbsolute, "/turn")
        self.create_timer(PERIOD, self.next)

    def on_star(self, message):
        """Called once for each star."""
        self.stars.append(message.data)
        self.next()

    def on_clouds(self, message):
        """Called when clouds come up."""
        if self.goal_handle is not None:
            self.goal_handle.cancel_goal_async()

    def next(self):
        """Send a goal for the next star, if there is one, and the telescope is there and free."""
        if self.busy or not self.stars or not self.client.server_is_ready():
            return
        self.busy = True
        star = self.stars.popleft()
        future = self.client.send_goal_async(RotateAbsolute.Goal(theta=star))
        future.add_done_callback(lambda done: self.on_response(star, done.result()))

    def on_response(self, star, handle):
        """Called when the telescope accepts or rejects a goal."""
        if not handle.accepted:
            self.finish(self.missed, star)
            return
        self.goal_handle = handle
        handle.get_result_async().add_done_callback(lambda done: self.on_result(star, done.result()))

    def on_result(self, star, answer):
        """Called when a goal is done."""
        self.finish(self.photo, star)

    def finish(self, publisher, star):
        """Publish the outcome for the star, and continue with the next one."""
        self.busy = False
        self.goal_handle = None
        publisher.publish(Float32(data=star))
        self.next()


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
