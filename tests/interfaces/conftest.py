"""Packages that are compiled once for all tests of this folder."""

from __future__ import annotations

from pathlib import Path

import pytest
from definitions import robot

from interface_compiler.store import Compiled, ensure


@pytest.fixture(scope="session")
def robot_interfaces(tmp_path_factory: pytest.TempPathFactory) -> Compiled:
    """A package of a message, a service and an action, which need each other and std_msgs and geometry_msgs."""
    return ensure(robot(), Path(tmp_path_factory.mktemp("store")))
