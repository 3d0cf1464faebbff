"""`ros2 topic`: list, measure, echo and publish."""

from __future__ import annotations

from ros_in_python.ros2.cli import Menu, MenuEntry

topic = Menu(
    name="topic",
    entries={
        "bw": MenuEntry("ros_in_python.ros2.topic.measuring:bw", "How many bytes per second a topic carries."),
        "delay": MenuEntry("ros_in_python.ros2.topic.measuring:delay", "How old messages are on arrival, by header."),
        "echo": MenuEntry("ros_in_python.ros2.topic.echo:echo", "Print the messages of a topic."),
        "find": MenuEntry("ros_in_python.ros2.topic.listing:find", "The topics of a type."),
        "hz": MenuEntry("ros_in_python.ros2.topic.measuring:hz", "How many messages per second arrive."),
        "info": MenuEntry("ros_in_python.ros2.topic.listing:info", "Who publishes and subscribes, with which QoS."),
        "list": MenuEntry("ros_in_python.ros2.topic.listing:list_", "All topics."),
        "pub": MenuEntry("ros_in_python.ros2.topic.pub:pub", "Publish messages."),
        "type": MenuEntry("ros_in_python.ros2.topic.listing:type_", "The type of a topic."),
    },
    help="""Watch, measure and publish topics.

    \b
      ros2 topic list -t
      ros2 topic hz /joint_commands
      ros2 topic pub --rate 10 /turtle1/cmd_vel geometry_msgs/msg/Twist '{linear: {x: 2.0}, angular: {z: 1.0}}'
    """,
)
