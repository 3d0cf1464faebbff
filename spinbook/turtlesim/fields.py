"""turtlesim's message fields: how they are filled, and what a request with them asks of the world.

No message type is imported here: whatever has the fields will do.
"""

from __future__ import annotations

from typing import Any, TypeVar

from spinbook.turtlesim.events import ColorReport, Event, PoseReport
from spinbook.turtlesim.world import World

Message = TypeVar("Message", bound=Any)


def fill_pose(message: Message, pose: PoseReport) -> Message:
    """Fill a turtlesim/msg/Pose."""
    message.x, message.y, message.theta = pose.x, pose.y, pose.theta
    message.linear_velocity, message.angular_velocity = pose.linear_velocity, pose.angular_velocity
    return message


def fill_color(message: Message, color: ColorReport) -> Message:
    """Fill a turtlesim/msg/Color."""
    message.r, message.g, message.b = color.r, color.g, color.b
    return message


def spawn(world: World, request: Any) -> list[Event]:
    """Do what x, y, theta and name, as in turtlesim/srv/Spawn, ask for."""
    return world.spawn(request.x, request.y, request.theta, request.name)


def set_pen(world: World, turtle: str, request: Any) -> list[Event]:
    """Do what r, g, b, width and off, as in turtlesim/srv/SetPen, ask for."""
    return world.set_pen(turtle, request.r, request.g, request.b, request.width, request.off)


def teleport_absolute(world: World, turtle: str, request: Any) -> list[Event]:
    """Do what x, y and theta, as in turtlesim/srv/TeleportAbsolute, ask for."""
    return world.teleport_absolute(turtle, request.x, request.y, request.theta)


def teleport_relative(world: World, turtle: str, request: Any) -> list[Event]:
    """Do what linear and angular, as in turtlesim/srv/TeleportRelative, ask for."""
    return world.teleport_relative(turtle, request.linear, request.angular)
