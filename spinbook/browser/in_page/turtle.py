"""Turtlesim's window: a program that requests the running turtlesim's picture, and drives the turtle by keys."""

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
    """Sends pictures to `page`, and takes keys from it: pairs of how far ahead and how far to the left, -1 to 1."""

    def __init__(self, page: Any) -> None:
        super().__init__("turtle_window", start_parameter_services=False, enable_rosout=False)
        self._page = page
        self._pictures = self.create_client(Trigger, "/turtlesim/picture")
        self._commands = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self._asked: Any = None
        self.create_timer(_PERIOD_S, self._look)

    def _look(self) -> None:
        while (key := self._page.key()) is not None:
            command = Twist()
            command.linear.x, command.angular.z = _SPEED * key.ahead, _SPEED * key.left
            self._commands.publish(command)
        if (self._asked is None or self._asked.done()) and self._pictures.service_is_ready():
            self._asked = self._pictures.call_async(Trigger.Request())
            self._asked.add_done_callback(lambda answer: self._page.picture(answer.result().message))


def show(page: Any) -> None:
    """Show the window until the program is asked to end."""
    rclpy.init(args=[])
    rclpy.spin(Window(page))
