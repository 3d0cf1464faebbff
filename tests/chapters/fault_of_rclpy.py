"""A fault of rclpy that a chapter's node can't avoid, so that it does not count."""

from __future__ import annotations

#: rclpy wakes a node before it shuts the context down (signal_handler.cpp of 7.1.3). A node that begins to wait again
#: in between ends with this, whatever its code: after SIGTERM, and after SIGINT if Python had to ignore its
#: KeyboardInterrupt because it came in a `__del__` of rclpy's. Seen in two of four runs of all tests, in one test each.
_TEXT = "failed to initialize wait set: the given context is not valid"


class FaultOfRclpy(Exception):
    """Raised when a node has ended with it. The test is then run again: see conftest.py."""


def raise_if_in(log: str) -> None:
    """Raise FaultOfRclpy, with the log, if a node's log tells of it."""
    if _TEXT in log:
        raise FaultOfRclpy(log)
