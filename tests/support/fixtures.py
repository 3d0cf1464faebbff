"""Fixtures for the tests here and for those of packages: a ROS domain of their own, interfaces that end with a file."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator

import pytest
import ros_domains

from interface_compiler import activation


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain that no other test and no notebook on this machine uses while the test runs.

    The environment is set up for it, so that rclpy in this process and in every child uses it, on loopback only.
    """
    with ros_domains.reserved() as domain:
        for name, value in ros_domains.environment(domain).items():
            monkeypatch.setenv(name, value)
        yield domain
        assert not ros_domains.nodes_left(), "a node is left in this process: the domain's next test would see it"


@pytest.fixture(scope="module", autouse=True)
def only_here() -> Iterator[None]:
    """Ends the interfaces that a file's tests activate with the file; later tests would use them, too.

    Reading an exercise is enough to activate what was compiled for its course, and a fixture of the session may do so.
    """
    yield
    compiled = {str(prefix) for prefix in activation.active()}
    for name in (activation.VARIABLE, "AMENT_PREFIX_PATH", "PYTHONPATH"):
        entries = os.environ.pop(name, "").split(os.pathsep)
        if kept := [entry for entry in entries if entry and not within(entry, compiled)]:
            os.environ[name] = os.pathsep.join(kept)
    sys.path[:] = [entry for entry in sys.path if not within(entry, compiled)]


def within(entry: str, folders: set[str]) -> bool:
    """Whether a path is one of these folders, or below one."""
    return any(entry == folder or entry.startswith(folder + os.sep) for folder in folders)
