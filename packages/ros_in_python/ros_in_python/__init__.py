"""What PyPI lacks of ROS 2, in Python: the `ros2` command, launch, turtlesim and the demo nodes, on rclpy alone."""
