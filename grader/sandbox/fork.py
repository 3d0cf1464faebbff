"""Forks a process that has rclpy in its memory."""

from __future__ import annotations

import os
import warnings


def fork() -> int:
    """The same as `os.fork`, without what Python warns of from 3.12 on where a process has several threads.

    Those beside Python's own are LTTng's: ROS 2's tracing starts two when rclpy is imported. They wait for a tracing
    daemon (lttng-ust(3), "LTTNG_UST_REGISTER_TIMEOUT"), and a child has no use for them.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "This process .* is multi-threaded", DeprecationWarning)
        return os.fork()
