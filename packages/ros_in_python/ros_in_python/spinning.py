"""A node as a program of its own, which runs until the process is stopped."""

from __future__ import annotations

import signal
from collections.abc import Callable
from types import FrameType

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

#: The most time between a signal and its effect if no timer runs, in s.
NOTICE_S = 0.1


def spin_until_stopped(make: Callable[[], Node]) -> int:
    """Initialize rclpy, make the node and spin it until the process is stopped; return the exit code.

    The signals are ours and not rclpy's: its own handlers shut the context down from another thread, so that a
    callback that is just publishing fails with RCLError (1 end in 60 of a node that publishes at 60 Hz), and
    try_shutdown may find the context valid that is shut down the next moment. Here the callback at hand is
    finished first.
    """
    stopped = False

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal stopped
        stopped = True

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        executor = SingleThreadedExecutor()
        executor.add_node(make())
        while not stopped:
            executor.spin_once(timeout_sec=NOTICE_S)
        executor.shutdown()
    finally:
        rclpy.shutdown()
    return 0
