"""Turtlesim's window: requests the picture from the running turtlesim, and drives the turtle with keys."""

from __future__ import annotations

import json
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_srvs.srv import Trigger

from ros_in_python.turtlesim.world_picture import WorldPicture, caption
from ros_in_python.turtlesim.world_svg import still_svg

#: How often the picture is requested (s).
_PERIOD_S = 0.25
#: How fast a key drives, as with the real teleop_turtle (units and radians per second).
_SPEED = 2.0


class Window(Node):
    """Sends pictures to `page` and takes keys from it. A key has `ahead` and `left`, each -1, 0 or 1."""

    def __init__(self, page: Any) -> None:
        super().__init__("_turtle_window", start_parameter_services=False, enable_rosout=False)
        self._page = page
        self._pictures = self.create_client(Trigger, "/turtlesim/picture")
        self._commands: Any = None
        self._requested: Any = None
        self.create_timer(_PERIOD_S, self._update)

    def _update(self) -> None:
        while (key := self._page.key()) is not None:
            # Only now, so that nobody sees a publisher while nobody drives.
            self._commands = self._commands or self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
            command = Twist()
            command.linear.x, command.angular.z = _SPEED * key.ahead, _SPEED * key.left
            self._commands.publish(command)
        if (self._requested is None or self._requested.done()) and self._pictures.service_is_ready():
            self._requested = self._pictures.call_async(Trigger.Request())
            self._requested.add_done_callback(lambda reply: self._show(reply.result().message))

    def _show(self, text: str) -> None:
        world = WorldPicture.from_json(text)
        self._page.picture(json.dumps({"svg": still_svg(world, "turtle"), "words": caption(world)}))


def show(page: Any) -> None:
    """Show the window until the program is interrupted."""
    rclpy.init(args=[])
    rclpy.spin(Window(page))
