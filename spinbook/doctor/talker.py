"""A program: publishes the time on `/spinbook_doctor` until its standard input is closed."""

from __future__ import annotations

import sys
import threading
import time

import rclpy
from std_msgs.msg import UInt64

TOPIC = "/spinbook_doctor"
_PERIOD_S = 0.02


def main() -> None:
    """Publish the monotonic clock (ns)."""
    closed = threading.Event()

    def listen() -> None:
        sys.stdin.read()
        closed.set()

    threading.Thread(target=listen, daemon=True).start()
    rclpy.init()
    publisher = rclpy.create_node("spinbook_doctor_talker").create_publisher(UInt64, TOPIC, 10)
    while not closed.wait(_PERIOD_S):
        publisher.publish(UInt64(data=time.monotonic_ns()))
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
