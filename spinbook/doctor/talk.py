"""Two programs, `python -m spinbook.doctor.talk` and the same with `listen`: one sends a message to the other."""

from __future__ import annotations

import json
import sys
import threading
import time

import rclpy
from std_msgs.msg import UInt64

TOPIC = "/spinbook_doctor"
_PERIOD_S = 0.02


def talk() -> None:
    """Publish the monotonic clock (ns) until standard input is closed."""
    closed = threading.Event()

    def read() -> None:
        sys.stdin.read()
        closed.set()

    threading.Thread(target=read, daemon=True).start()
    rclpy.init()
    publisher = rclpy.create_node("spinbook_doctor_talker").create_publisher(UInt64, TOPIC, 10)
    while not closed.wait(_PERIOD_S):
        publisher.publish(UInt64(data=time.monotonic_ns()))
    rclpy.try_shutdown()


def listen() -> None:
    """Print `meeting_s`, from the node's start to the first message, and `travel_s`, the message's own time (s)."""
    rclpy.init()
    node = rclpy.create_node("spinbook_doctor_listener")
    travels: list[float] = []

    def keep(message: UInt64) -> None:
        travels.append(time.monotonic_ns() - message.data)

    node.create_subscription(UInt64, TOPIC, keep, 10)
    start = time.monotonic()
    while not travels:
        rclpy.spin_once(node, timeout_sec=0.1)
    print(json.dumps({"meeting_s": time.monotonic() - start, "travel_s": travels[0] / 1e9}), flush=True)
    rclpy.try_shutdown()


if __name__ == "__main__":
    listen() if sys.argv[1:] == ["listen"] else talk()
