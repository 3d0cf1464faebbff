"""Stops publishing at the goal, so that the turtle rolls on for a second.

Caught by:
- test_stops_at_the_goal
- test_does_not_go_past_the_goal
"""

import math

import rclpy
from geometry_msgs.msg import Point, Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose

FASTEST = 2.0  # m/s
FASTEST_TURN = 2.0  # rad/s
CLOSE_ENOUGH = 0.05  # m


class GoToGoal(Node):

    def __init__(self):
        super().__init__('go_to_goal')
        self.goal = None
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Point, '/goal', self.on_goal, 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.get_logger().info('Waiting for a goal')

    def on_goal(self, goal):
        self.get_logger().info(f'Next goal: x {goal.x:.2f}, y {goal.y:.2f}')
        self.goal = goal

    def on_pose(self, pose):
        if self.goal is None:
            return
        ahead, left = self.goal.x - pose.x, self.goal.y - pose.y
        distance = math.hypot(ahead, left)
        command = Twist()
        if distance < CLOSE_ENOUGH:
            self.goal = None
            return
        else:
            turn = wrapped(math.atan2(left, ahead) - pose.theta)
            command.linear.x = FASTEST * (abs(turn) < 0.8)
            command.angular.z = max(-FASTEST_TURN, min(4.0 * turn, FASTEST_TURN))
        self.publisher.publish(command)


def wrapped(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


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
