"""ROS domains for tests: each belongs to one test, or one fixture, alone on this machine."""

from __future__ import annotations

import fcntl
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ros_in_python.ros2.domain import participants

LOOPBACK = Path(__file__).parents[2] / "spinbook" / "kernel" / "loopback.xml"


@contextmanager
def reserved() -> Iterator[int]:
    """Reserve a ROS domain that no other test and no notebook on this machine uses meanwhile."""
    # Domains above 60 are for tests; notebooks use those below.
    locks = Path(tempfile.gettempdir()) / "spinbook-test-domains"
    locks.mkdir(exist_ok=True)
    for domain in range(61, 100):
        with (locks / str(domain)).open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            if participants(domain):  # a process of its last test is still ending
                continue
            yield domain
            return
    raise RuntimeError("every ROS domain from 61 to 99 is in use by another test")


def environment(domain: int) -> dict[str, str]:
    """Return the variables with which rclpy, here and in children, uses a domain, on loopback only."""
    return {
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
        "FASTRTPS_DEFAULT_PROFILES_FILE": str(LOOPBACK),
    }


def nodes_left() -> int:
    """Return how many contexts in this process Fast DDS still keeps in their ROS domains: each has an event thread."""
    names = (task.read_text() for task in Path("/proc/self/task").glob("*/comm"))
    return sum(name.startswith("dds.ev.") for name in names)
