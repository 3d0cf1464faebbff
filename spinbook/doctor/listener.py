"""A program: waits for a message on `/spinbook_doctor`, and prints what it took as one line of JSON."""

from __future__ import annotations

import json
import time

import rclpy
from std_msgs.msg import UInt64

from spinbook.doctor.talker import TOPIC


def main() -> None:
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
    main()
