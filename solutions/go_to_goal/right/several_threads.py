"""With a MultiThreadedExecutor and a lock."""

import math
import threading

import rclpy
from geometry_msgs.msg import Point, Twist
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from turtlesim.msg import Pose


class GoToGoal(Node):
    def __init__(self):
        super().__init__('go_to_goal')
        self.lock = threading.Lock()
        self.goal = None
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        one, two = MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()
        self.create_subscription(Point, '/goal', self.on_goal, 10, callback_group=one)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10, callback_group=two)

    def on_goal(self, goal):
        with self.lock:
            self.goal = goal

    def on_pose(self, pose):
        with self.lock:
            goal = self.goal
        if goal is None:
            return
        dx, dy = goal.x - pose.x, goal.y - pose.y
        rho = math.hypot(dx, dy)
        command = Twist()
        if rho > 0.05:
            turn = math.atan2(dy, dx) - pose.theta
            while turn > math.pi:
                turn -= 2 * math.pi
            while turn < -math.pi:
                turn += 2 * math.pi
            command.angular.z = max(-2.0, min(2.0, 4.0 * turn))
            command.linear.x = max(0.0, min(2.0, 1.5 * rho) * math.cos(turn))
        else:
            self.forget(goal)
        self.publisher.publish(command)

    def forget(self, goal):
        with self.lock:
            if self.goal is goal:  # and not a newer one
                self.goal = None


def main():
    rclpy.init()
    node = GoToGoal()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
