"""Packages that are compiled once for all tests of this folder."""

from __future__ import annotations

import fcntl
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from definitions import robot

from interface_compiler.store import CompiledPackages, ensure

#: A ROS domain that no other tests use, below those whose ports Linux gives to anybody.
DOMAIN = 100


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain that no other test of this package on this machine uses meanwhile."""
    with Path(tempfile.gettempdir(), f"ros-domain-{DOMAIN}").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
        monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        yield DOMAIN


@pytest.fixture(scope="session")
def robot_interfaces(tmp_path_factory: pytest.TempPathFactory) -> CompiledPackages:
    """A package of a message, a service and an action, which need each other and std_msgs and geometry_msgs."""
    return ensure(robot(), Path(tmp_path_factory.mktemp("store")))
