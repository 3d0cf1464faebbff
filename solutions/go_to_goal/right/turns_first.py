"""Turns on the spot, then drives straight ahead."""

import math

import rclpy
from geometry_msgs.msg import Point, Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose


class GoToGoal(Node):
    def __init__(self):
        super().__init__('go_to_goal')
        self.goal = None
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Point, '/goal', self.on_goal, 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)

    def on_goal(self, msg):
        self.goal = (msg.x, msg.y)

    def on_pose(self, pose):
        cmd = Twist()
        if self.goal is not None:
            dx, dy = self.goal[0] - pose.x, self.goal[1] - pose.y
            error = math.remainder(math.atan2(dy, dx) - pose.theta, 2 * math.pi)
            if math.hypot(dx, dy) < 0.04:
                self.goal = None
            elif abs(error) > 0.1:
                cmd.angular.z = math.copysign(min(2.0, 3.0 * abs(error)), error)
            else:
                cmd.linear.x = min(2.0, 1.5 * math.hypot(dx, dy) + 0.05)
                cmd.angular.z = 2.0 * error
        self.pub.publish(cmd)


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
