"""Positions and headings as complex numbers."""

import cmath

import rclpy
from geometry_msgs.msg import Point, Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose


class GoToGoal(Node):
    goal = None

    def __init__(self):
        Node.__init__(self, 'go_to_goal')
        self.publisher = self.create_publisher(Twist, 'turtle1/cmd_vel', 10)
        self.goals = self.create_subscription(Point, 'goal', self.on_goal, 10)
        self.poses = self.create_subscription(Pose, 'turtle1/pose', self.on_pose, 10)

    def on_goal(self, msg):
        self.goal = complex(msg.x, msg.y)

    def on_pose(self, msg):
        if self.goal is None:
            return
        way = self.goal - complex(msg.x, msg.y)
        command = Twist()
        if abs(way) >= 0.03:
            ahead = way * cmath.exp(-1j * msg.theta)
            turn = cmath.phase(ahead)
            command.linear.x = max(0.0, min(2.0, 1.8 * ahead.real)) if abs(turn) < 1.0 else 0.0
            command.angular.z = max(-2.0, min(2.0, 5.0 * turn))
        else:
            self.goal = None
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
