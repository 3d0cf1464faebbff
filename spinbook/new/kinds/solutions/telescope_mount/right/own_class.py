"""The mount is a class of its own; a reentrant group and a rate in place of the clock's sleep."""

import math

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from turtlesim.action import RotateAbsolute


class Mount:
    def __init__(self):
        self.angle = 0.0

    def step(self, goal):
        """Turn, and return what remains."""
        self.angle += max(-0.1, min(0.1, goal - self.angle))
        if math.isclose(self.angle, goal, abs_tol=1e-12):
            self.angle = goal
        return goal - self.angle


class TelescopeMount(Node):
    def __init__(self):
        super().__init__("telescope_mount")
        self.mount = Mount()
        self.goal = None
        self.server = ActionServer(
            self,
            RotateAbsolute,
            "/point",
            execute_callback=self.execute,
            callback_group=ReentrantCallbackGroup(),
            goal_callback=self.judge,
            handle_accepted_callback=self.begin,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def judge(self, goal):
        free = self.goal is None or not self.goal.is_active
        return GoalResponse.ACCEPT if free and abs(goal.theta) <= 1.5 else GoalResponse.REJECT

    def begin(self, handle):
        self.goal = handle
        handle.execute()

    def execute(self, handle):
        result = RotateAbsolute.Result()
        rate = self.create_rate(2)
        while self.mount.angle != handle.request.theta:
            rate.sleep()
            if handle.is_cancel_requested:
                self.destroy_rate(rate)
                handle.canceled()
                return result
            before = self.mount.angle
            remaining = self.mount.step(handle.request.theta)
            result.delta += self.mount.angle - before
            handle.publish_feedback(RotateAbsolute.Feedback(remaining=remaining))
        self.destroy_rate(rate)
        handle.succeed()
        return result


def main():
    rclpy.init()
    node = TelescopeMount()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
