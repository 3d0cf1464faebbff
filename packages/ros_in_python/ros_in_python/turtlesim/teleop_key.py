"""The node `teleop_turtle`, which drives turtle1 from the keyboard: `python -m ros_in_python.turtlesim.teleop_key`."""

from __future__ import annotations

import contextlib
import os
import sys
import termios
import threading
from collections.abc import Iterator
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from rclpy.node import Node

from ros_in_python.spinning import spin_until_stopped
from ros_in_python.turtlesim.messages import RotateAbsolute

HELP = """\
Reading from keyboard
---------------------------
Use arrow keys to move the turtle.
Use g|b|v|c|d|e|r|t keys to rotate to absolute orientations. 'f' to cancel a rotation.
'q' to quit."""

#: The last byte that an arrow key sends -> forward and turn, each times its scale.
ARROWS = {b"A": (1.0, 0.0), b"B": (-1.0, 0.0), b"C": (0.0, -1.0), b"D": (0.0, 1.0)}
#: Key -> heading (rad), rounded as turtlesim has them. On the keyboard they are around F as on a compass.
HEADINGS = {
    **{b"g": 0.0, b"t": 0.7854, b"r": 1.5708, b"e": 2.3562},
    **{b"d": 3.1416, b"c": -2.3562, b"v": -1.5708, b"b": -0.7854},
}


class Teleop:
    """What the keys do."""

    def __init__(self) -> None:
        self.node = Node("teleop_turtle")
        self.node.declare_parameter("scale_angular", 2.0)
        self.node.declare_parameter("scale_linear", 2.0)
        self._twists = self.node.create_publisher(Twist, "turtle1/cmd_vel", 1)
        self._rotation = ActionClient(self.node, RotateAbsolute, "turtle1/rotate_absolute")
        self._asked: Any = None

    def press(self, key: bytes) -> None:
        """Do what a key stands for, if anything."""
        if key in ARROWS:
            self._drive(*ARROWS[key])
        elif key.lower() in HEADINGS:
            self._asked = self._rotation.send_goal_async(RotateAbsolute.Goal(theta=HEADINGS[key.lower()]))
        elif key.lower() == b"f" and self._asked is not None:
            # At once if the answer has arrived, otherwise as soon as it does.
            self._asked.add_done_callback(_cancel)

    def _drive(self, forward: float, turn: float) -> None:
        twist = Twist()
        twist.linear.x = forward * float(self.node.get_parameter("scale_linear").value)
        twist.angular.z = turn * float(self.node.get_parameter("scale_angular").value)
        self._twists.publish(twist)


def _cancel(asked: Any) -> None:
    if asked.result().accepted:
        asked.result().cancel_goal_async()


@contextlib.contextmanager
def single_keys(terminal: int) -> Iterator[None]:
    """Let a terminal pass on each key at once, without showing it."""
    before = termios.tcgetattr(terminal)
    now = termios.tcgetattr(terminal)
    now[3] &= ~(termios.ICANON | termios.ECHO)
    termios.tcsetattr(terminal, termios.TCSANOW, now)
    try:
        yield
    finally:
        termios.tcsetattr(terminal, termios.TCSANOW, before)


def keys(terminal: int) -> Iterator[bytes]:
    """Yield the keys as they are pressed, until Q or the terminal's end; of an arrow key only its last byte."""
    escape = b""
    while (byte := os.read(terminal, 1)) not in (b"", b"q", b"Q"):
        escape = (escape + byte)[-3:]
        # A letter alone is not an arrow: those send ESC [ A, or ESC O A.
        if byte not in ARROWS or escape[:2] in (b"\x1b[", b"\x1bO"):
            yield byte
        elif byte.lower() in HEADINGS:
            yield byte.lower()


def main() -> int:
    """Run the node until Q is pressed or it is stopped; return the exit code."""
    terminal = sys.stdin.fileno()
    if not os.isatty(terminal):
        print("turtle_teleop_key reads keys from a terminal: run it in one.", file=sys.stderr)
        return 1

    def make() -> Node:
        teleop = Teleop()
        print(HELP, flush=True)
        threading.Thread(target=_listen, args=(teleop, terminal), daemon=True).start()
        return teleop.node

    with single_keys(terminal):
        return spin_until_stopped(make)


def _listen(teleop: Teleop, terminal: int) -> None:
    for key in keys(terminal):
        teleop.press(key)
    # As Ctrl-C does: the node is spinning in the main thread.
    os.kill(os.getpid(), 2)


if __name__ == "__main__":
    sys.exit(main())
