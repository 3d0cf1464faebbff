"""Names of topics, services, actions and nodes, as typed and in full."""

from __future__ import annotations

from collections.abc import Iterable

from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.validate_full_topic_name import validate_full_topic_name

from spinbook.ros2.refusal import Refusal


def absolute(name: str, what: str = "topic") -> str:
    """The full name of a topic, service or action: `chatter` -> `/chatter`. Raises `Refusal` for no valid name."""
    try:
        full: str = expand_topic_name(name, "ros2", "/")
        validate_full_topic_name(full)
    except (InvalidTopicNameException, InvalidServiceNameException, ValueError) as error:
        # The rest tells where in the C source of rcl it was noticed.
        reason = str(error).split("\n")[0].partition(", at /")[0]
        raise Refusal(
            f"'{name}' is no name for a {what}: {reason}",
            "A name has letters, digits and underscores, in parts divided by '/', as in /left_foot/pressure.",
        ) from None
    return full


def absolute_node(name: str) -> str:
    """The full name of a node: `joint_monitor` -> `/joint_monitor`."""
    return name if name.startswith("/") else f"/{name}"


def seen(what: str, names: Iterable[str]) -> str:
    """A line that says what of a kind is there instead: `Topics seen: /a, /b`."""
    listed = ", ".join(sorted(set(names)))
    return f"{what} seen: {listed or 'none'}. ROS_DOMAIN_ID must be the same in every terminal and notebook."
