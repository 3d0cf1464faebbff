"""A ROS 2 middleware without a network: programs run in the time of a hub, which knows when they are idle."""
