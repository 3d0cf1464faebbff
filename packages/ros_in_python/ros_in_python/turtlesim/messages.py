"""Loads turtlesim's message types."""

from __future__ import annotations

from interface_compiler import shipped

try:
    from turtlesim.action import RotateAbsolute
    from turtlesim.msg import Color, Pose
    from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative
except ImportError:
    raise SystemExit(
        f"turtlesim's messages are not installed here. {shipped.how_to_add('turtlesim')}\n"
        "With a sourced ROS 2: sudo apt-get install ros-jazzy-turtlesim"
    ) from None

__all__ = ["Color", "Kill", "Pose", "RotateAbsolute", "SetPen", "Spawn", "TeleportAbsolute", "TeleportRelative"]
