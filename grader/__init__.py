"""Grades students' ROS 2 nodes by spinning them, sandboxed, against reference publishers."""
