"""`ros2 launch`: reads the launch files that courses write (Python, YAML, XML), and runs their nodes.

ROS 2's own `launch` and `launch_ros` are in no package registry, so this is a reader of a part of their API, and says
so where a file asks for more. Names and behaviour follow https://github.com/ros2/launch and
https://github.com/ros2/launch_ros (Jazzy).
"""
