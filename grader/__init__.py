"""Grades students' ROS 2 nodes by running them in a sandbox, against reference publishers."""
