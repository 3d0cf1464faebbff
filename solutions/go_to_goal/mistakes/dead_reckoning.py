"""Computes once how long to turn and to drive, and ignores the poses on the way.

Caught by:
- test_reaches_the_goal
"""

import math

import rclpy
from geometry_msgs.msg import Point, Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose


class GoToGoal(Node):
    def __init__(self):
        super().__init__('go_to_goal')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Point, '/goal', self.on_goal, 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.create_timer(0.1, self.tick)
        self.pose = None
        self.plan = []

    def on_pose(self, pose):
        self.pose = pose

    def on_goal(self, goal):
        if self.pose is None:
            return
        dx, dy = goal.x - self.pose.x, goal.y - self.pose.y
        turn = math.remainder(math.atan2(dy, dx) - self.pose.theta, 2 * math.pi)
        self.plan = [(0.0, math.copysign(1.0, turn))] * round(abs(turn) * 10)
        self.plan += [(1.8, 0.0)] * round(math.hypot(dx, dy) / 0.18) + [(0.0, 0.0)]

    def tick(self):
        if self.plan:
            command = Twist()
            command.linear.x, command.angular.z = self.plan.pop(0)
            self.publisher.publish(command)


def main():
    rclpy.init()
    node = GoToGoal()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
