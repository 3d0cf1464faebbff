"""Has the class, and forgets to call main()."""

from rclpy.node import Node


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity')
