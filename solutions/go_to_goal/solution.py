"""Drive the turtle to the goal that was published last, and stop there."""

import math

import rclpy
from geometry_msgs.msg import Point, Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose

FASTEST = 2.0  # m/s
FASTEST_TURN = 2.0  # rad/s
CLOSE_ENOUGH = 0.08  # m


class GoToGoal(Node):
    """Compares where the turtle is with where it should be, and steers."""

    def __init__(self):
        super().__init__('go_to_goal')
        self.goal = None
        # TODO: create a publisher of Twist messages on '/turtle1/cmd_vel', with a queue depth of 10.
        # TODO: subscribe to '/goal' (Point) with self.on_goal, and to '/turtle1/pose' (Pose) with self.on_pose.
        # BEGIN SOLUTION
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Point, '/goal', self.on_goal, 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        # END SOLUTION
        self.get_logger().info('Waiting for a goal')

    def on_goal(self, goal):
        """Called once for each goal."""
        self.get_logger().info(f'Next goal: x {goal.x:.2f}, y {goal.y:.2f}')
        self.goal = goal

    def on_pose(self, pose):
        """Called once for each pose of the turtle, about 60 times per second."""
        # TODO: without a goal, do nothing.
        # TODO: find the distance to the goal, and by which angle the turtle must turn to face it.
        # TODO: close to the goal, stop the turtle and forget the goal. Otherwise drive and turn towards it.
        # BEGIN SOLUTION
        if self.goal is None:
            return
        ahead, left = self.goal.x - pose.x, self.goal.y - pose.y
        distance = math.hypot(ahead, left)
        command = Twist()
        if distance < CLOSE_ENOUGH:
            self.goal = None
        else:
            turn = wrapped(math.atan2(left, ahead) - pose.theta)
            command.linear.x = min(distance, FASTEST) * max(math.cos(turn), 0.0)
            command.angular.z = max(-FASTEST_TURN, min(4.0 * turn, FASTEST_TURN))
        self.publisher.publish(command)
        # END SOLUTION


# BEGIN SOLUTION
def wrapped(angle):
    """The same angle between -pi and pi."""
    return math.atan2(math.sin(angle), math.cos(angle))


# END SOLUTION
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
