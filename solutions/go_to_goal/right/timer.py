"""Steers from a timer at 20 Hz, with the newest pose."""

import math

import rclpy
from geometry_msgs.msg import Point, Twist, Vector3
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose


class GoToGoal(Node):
    def __init__(self):
        super().__init__('go_to_goal')
        self.goal = self.pose = None
        self.commands = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Point, '/goal', lambda goal: setattr(self, 'goal', goal), 10)
        self.create_subscription(Pose, '/turtle1/pose', lambda pose: setattr(self, 'pose', pose), 10)
        self.create_timer(0.05, self.steer)

    def steer(self):
        if self.goal is None or self.pose is None:
            return
        x, y = self.goal.x - self.pose.x, self.goal.y - self.pose.y
        rho = math.sqrt(x * x + y * y)
        if rho < 0.06:
            self.commands.publish(Twist())
            self.goal = None
            return
        alpha = (math.atan2(y, x) - self.pose.theta + math.pi) % (2 * math.pi) - math.pi
        speed = min(1.2 * rho, 1.8) if abs(alpha) < 0.6 else 0.0
        turn = min(max(3.0 * alpha, -1.9), 1.9)
        self.commands.publish(Twist(linear=Vector3(x=speed), angular=Vector3(z=turn)))


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
