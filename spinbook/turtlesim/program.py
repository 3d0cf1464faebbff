"""Runs a turtlesim node as a program, and loads turtlesim's message types."""

from __future__ import annotations

import signal
from collections.abc import Callable
from types import FrameType

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

#: A signal is noticed within this long even where no timer runs, in s.
_NOTICE_S = 0.1


def spin_until_stopped(make: Callable[[], Node]) -> int:
    """Initialize rclpy, make the node and spin it until the process is stopped; return the exit code.

    The signals are ours and not rclpy's: its own handlers shut the context down from another thread, so that a
    callback that is just publishing fails with RCLError (1 end in 60 of a node that publishes at 60 Hz), and
    try_shutdown may find the context valid that is shut down the next moment. Here the callback at hand is
    finished first.
    """
    text = False

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal text
        text = True

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        executor = SingleThreadedExecutor()
        executor.add_node(make())
        while not text:
            executor.spin_once(timeout_sec=_NOTICE_S)
        executor.shutdown()
    finally:
        rclpy.shutdown()
    return 0


try:
    from turtlesim.action import RotateAbsolute
    from turtlesim.msg import Color, Pose
    from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative
except ImportError:
    raise SystemExit(
        "turtlesim's messages are not installed here. In a checkout, `make setup` compiles them. Elsewhere: "
        "`spinbook interfaces add turtlesim`. With a sourced ROS 2: sudo apt-get install ros-jazzy-turtlesim"
    ) from None

__all__ = ["Color", "Kill", "Pose", "RotateAbsolute", "SetPen", "Spawn", "TeleportAbsolute", "TeleportRelative"]
