"""Turtlesim's window: requests the picture from the running turtlesim, and drives the turtle with keys."""

from __future__ import annotations

from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_srvs.srv import Trigger

#: How often the picture is requested (s).
_PERIOD_S = 0.25
#: How fast a key drives, as with the real teleop_turtle (units and radians per second).
_SPEED = 2.0


class Window(Node):
    """Sends pictures to `page` and takes keys from it. A key has `ahead` and `left`, each -1, 0 or 1."""

    def __init__(self, page: Any) -> None:
        super().__init__("turtle_window", start_parameter_services=False, enable_rosout=False)
        self._page = page
        self._pictures = self.create_client(Trigger, "/turtlesim/picture")
        self._commands = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self._requested: Any = None
        self.create_timer(_PERIOD_S, self._update)

    def _update(self) -> None:
        while (key := self._page.key()) is not None:
            command = Twist()
            command.linear.x, command.angular.z = _SPEED * key.ahead, _SPEED * key.left
            self._commands.publish(command)
        if (self._requested is None or self._requested.done()) and self._pictures.service_is_ready():
            self._requested = self._pictures.call_async(Trigger.Request())
            self._requested.add_done_callback(lambda reply: self._page.picture(reply.result().message))


def show(page: Any) -> None:
    """Show the window until the program is interrupted."""
    rclpy.init(args=[])
    rclpy.spin(Window(page))
