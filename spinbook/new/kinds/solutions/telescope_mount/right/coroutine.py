"""One thread is enough: execute is a coroutine that awaits a future, and a timer does the turning."""

import math

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from turtlesim.action import RotateAbsolute


class TelescopeMount(Node):
    def __init__(self):
        super().__init__("telescope_mount")
        self.angle = 0.0
        self.running = False
        self.server = ActionServer(
            self, RotateAbsolute, "/point", self.execute, goal_callback=self.judge, cancel_callback=self.on_cancel
        )

    def judge(self, goal):
        if self.running or not abs(goal.theta) <= 1.5:
            return GoalResponse.REJECT
        self.running = True
        return GoalResponse.ACCEPT

    def on_cancel(self, _):
        return CancelResponse.ACCEPT

    async def execute(self, handle):
        begin, goal = self.angle, handle.request.theta
        done = Future()

        def turn():
            if handle.is_cancel_requested:
                done.set_result(False)
                return
            remaining = goal - self.angle
            self.angle = goal if abs(remaining) <= 0.1 else self.angle + math.copysign(0.1, remaining)
            handle.publish_feedback(RotateAbsolute.Feedback(remaining=goal - self.angle))
            if self.angle == goal:
                done.set_result(True)

        if self.angle == goal:
            done.set_result(True)
            timer = None
        else:
            timer = self.create_timer(0.5, turn)
        reached = await done
        if timer is not None:
            self.destroy_timer(timer)
        handle.succeed() if reached else handle.canceled()
        self.running = False
        return RotateAbsolute.Result(delta=self.angle - begin)


def main():
    rclpy.init()
    node = TelescopeMount()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
