"""The part of the `ros2` command that courses use, on rclpy alone, for machines without a ROS installation."""
