"""What the tests of rcl in Python share."""

from __future__ import annotations

import fcntl
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

#: A ROS domain that no other tests use, below those whose ports Linux gives to anybody.
DOMAIN = 101


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain that no other test of this package on this machine uses meanwhile."""
    with Path(tempfile.gettempdir(), f"ros-domain-{DOMAIN}").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
        monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        yield DOMAIN
