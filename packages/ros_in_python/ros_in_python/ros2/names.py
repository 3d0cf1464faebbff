"""Names of topics, services, actions and nodes as people type them."""

from __future__ import annotations

from collections.abc import Iterable

from ros_in_python.ros2.cli import CommandError


def absolute(name: str, what: str = "topic") -> str:
    """Return the full name of a topic, service or action: `/chatter`. Raises `CommandError` if it is not valid."""
    from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        full: str = expand_topic_name(name, "ros2", "/")
        validate_full_topic_name(full)
    except (InvalidTopicNameException, InvalidServiceNameException, ValueError) as error:
        # The rest is a place in the C source of rcl.
        reason = str(error).split("\n")[0].partition(", at /")[0]
        raise CommandError(
            f"'{name}' is not a valid name for a {what}: {reason}",
            "A name has letters, digits and underscores, in parts divided by '/', as in /left_foot/pressure.",
        ) from None
    return full


def absolute_node(name: str) -> str:
    """Return the full name of a node: `joint_monitor` -> `/joint_monitor`."""
    return name if name.startswith("/") else f"/{name}"


def seen(what: str, names: Iterable[str]) -> str:
    """Return a line that says which names there are instead: `Topics seen: /a, /b`."""
    listed = ", ".join(sorted(set(names)))
    return f"{what} seen: {listed or 'none'}. ROS_DOMAIN_ID must be the same in every terminal and notebook."
