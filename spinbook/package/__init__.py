"""The ROS 2 package that the chapters' node cells make."""
