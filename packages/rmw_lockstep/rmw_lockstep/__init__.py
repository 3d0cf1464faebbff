"""A ROS 2 middleware without a network: programs run in the time of a hub, which knows when they are idle."""

#: What `rclpy.get_rmw_implementation_identifier()` returns if this middleware was loaded.
IDENTIFIER = "rmw_lockstep_cpp"
