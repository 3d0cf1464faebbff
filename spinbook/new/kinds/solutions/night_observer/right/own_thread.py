"""A thread of its own photographs: it may wait, and the callbacks continue."""

import queue
import threading

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Empty, Float32
from turtlesim.action import RotateAbsolute


class NightObserver(Node):
    def __init__(self):
        super().__init__("night_observer")
        self.stars = queue.Queue()
        self.there = threading.Event()
        self.goal_handle = None
        self.photo = self.create_publisher(Float32, "/photo", 10)
        self.missed = self.create_publisher(Float32, "/missed", 10)
        self.client = ActionClient(self, RotateAbsolute, "/turn")
        self.create_subscription(Float32, "/star", lambda star: self.stars.put(star.data), 10)
        self.create_subscription(Empty, "/clouds", self.on_clouds, 10)
        self.create_timer(0.5, self.look)
        threading.Thread(target=self.photograph, daemon=True).start()

    def look(self):
        if self.client.server_is_ready():
            self.there.set()

    def on_clouds(self, _):
        if self.goal_handle is not None:
            self.goal_handle.cancel_goal_async()

    def photograph(self):
        while True:
            star = self.stars.get()
            if not self.client.server_is_ready():
                self.there.clear()
                self.there.wait()
            publisher = self.photo if self.turned(star) else self.missed
            publisher.publish(Float32(data=star))

    def turned(self, star):
        self.goal_handle = waited(self.client.send_goal_async(RotateAbsolute.Goal(theta=star)))
        if not self.goal_handle.accepted:
            self.goal_handle = None
            return False
        status = waited(self.goal_handle.get_result_async()).status
        self.goal_handle = None
        return status == GoalStatus.STATUS_SUCCEEDED


def waited(future):
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    done.wait()
    return future.result()


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
