"""The fork of the worker and of the judging processes."""

from __future__ import annotations

import os
import sys
import warnings


def fork() -> int:
    """Fork as `os.fork` does, without the warning that Python 3.12 and later print if a process has several threads.

    The other threads are LTTng's: ROS 2's tracing starts two when rclpy is imported. They wait for a tracing
    daemon (lttng-ust(3), "LTTNG_UST_REGISTER_TIMEOUT"), and a child has no use for them.
    """
    if sys.version_info < (3, 12):
        return os.fork()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "This process .* is multi-threaded", DeprecationWarning)
        return os.fork()
