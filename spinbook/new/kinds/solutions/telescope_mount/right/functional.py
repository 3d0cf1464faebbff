"""Without a class: closures, and a dictionary with the angle."""

import math

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from turtlesim.action import RotateAbsolute


def towards(angle, goal):
    if math.fabs(goal - angle) <= 0.1:
        return goal
    return angle + 0.1 if goal > angle else angle - 0.1


def main():
    rclpy.init()
    node = rclpy.create_node("telescope_mount")
    mount = {"angle": 0.0, "busy": False}

    def on_goal(goal):
        if mount["busy"] or abs(goal.theta) > 1.5 or math.isnan(goal.theta):
            return GoalResponse.REJECT
        mount["busy"] = True
        return GoalResponse.ACCEPT

    def execute(handle):
        begin, goal = mount["angle"], handle.request.theta
        try:
            while mount["angle"] != goal:
                node.get_clock().sleep_for(Duration(nanoseconds=500_000_000))
                if handle.is_cancel_requested:
                    handle.canceled()
                    return RotateAbsolute.Result(delta=mount["angle"] - begin)
                mount["angle"] = towards(mount["angle"], goal)
                handle.publish_feedback(RotateAbsolute.Feedback(remaining=goal - mount["angle"]))
            handle.succeed()
            return RotateAbsolute.Result(delta=mount["angle"] - begin)
        finally:
            mount["busy"] = False

    ActionServer(
        node,
        RotateAbsolute,
        "point",
        execute,
        goal_callback=on_goal,
        cancel_callback=lambda handle: CancelResponse.ACCEPT,
    )
    executor = MultiThreadedExecutor(num_threads=3)
    try:
        rclpy.spin(node, executor)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
