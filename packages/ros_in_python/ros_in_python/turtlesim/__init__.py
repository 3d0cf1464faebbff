"""Our own turtlesim: the node, its kinematics and its picture, for machines with neither Qt nor a ROS installation."""
