"""A state machine: waits, turns, drives."""

import math
from enum import Enum, auto

import rclpy
from geometry_msgs.msg import Point, Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose


class State(Enum):
    WAITING = auto()
    TURNING = auto()
    DRIVING = auto()


class GoToGoal(Node):
    def __init__(self):
        super().__init__('go_to_goal')
        self.state = State.WAITING
        self.goal = None
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Point, '/goal', self.on_goal, 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)

    def on_goal(self, goal):
        self.goal, self.state = goal, State.TURNING

    def on_pose(self, pose):
        if self.state is State.WAITING:
            return
        distance = math.dist((self.goal.x, self.goal.y), (pose.x, pose.y))
        bearing = math.atan2(self.goal.y - pose.y, self.goal.x - pose.x)
        error = math.atan2(math.sin(bearing - pose.theta), math.cos(bearing - pose.theta))
        command = Twist()
        if distance < 0.05:
            self.state = State.WAITING
        elif self.state is State.TURNING:
            command.angular.z = max(-2.0, min(2.0, 4.0 * error))
            if abs(error) < 0.05:
                self.state = State.DRIVING
        else:
            command.linear.x = min(2.0, max(0.2, 1.5 * distance))
            command.angular.z = max(-2.0, min(2.0, 4.0 * error))
            if abs(error) > 0.8:
                self.state = State.TURNING
                command.linear.x = 0.0
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
