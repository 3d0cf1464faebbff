"""The fork of the worker and of the judging processes, and how much memory a fork may take."""

from __future__ import annotations

import os
import resource
import warnings
from pathlib import Path


def fork() -> int:
    """Fork as `os.fork` does, without the warning that Python 3.12 and later print if a process has several threads.

    The other threads are LTTng's: ROS 2's tracing starts two when rclpy is imported. They wait for a tracing
    daemon (lttng-ust(3), "LTTNG_UST_REGISTER_TIMEOUT"), and a child has no use for them.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "This process .* is multi-threaded", DeprecationWarning)
        return os.fork()


#: How much more memory than at its start a process may take that holds what one submission did (bytes).
MOST_MORE_MEMORY = 1 << 30


def limit_memory() -> None:
    """Let this process, and those that it starts, take so much more memory; then Python raises MemoryError.

    The hub's own limits are far below this: it only keeps a gap in them away from the machine's other programs. Files
    that are mapped, such as libraries, do not count (RLIMIT_DATA in setrlimit(2)).
    """
    most = _private_memory() + MOST_MORE_MEMORY
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    if hard == resource.RLIM_INFINITY or most < hard:
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))


def _private_memory() -> int:
    pages = Path("/proc/self/statm").read_text().split()[5]  # proc(5): data and stack
    return int(pages) * resource.getpagesize()
