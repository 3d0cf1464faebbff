"""What the hub's tests share: a hub in a folder of its own, and processes that end with the test."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from programs import Watch
from stand_in import Process, Raw, Waits

from rmw_lockstep.hub import Hub, HubLimits


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder with a short path: the path of a socket has to be short."""
    with tempfile.TemporaryDirectory(prefix="hub-") as path:
        yield Path(path)


@pytest.fixture
def limits() -> HubLimits:
    """To be overridden."""
    return HubLimits()


@pytest.fixture
def hub(folder: Path, limits: HubLimits) -> Iterator[Hub]:
    with Hub(folder, limits, Waits()) as hub:
        yield hub


@pytest.fixture
def process(hub: Hub) -> Iterator[Callable[..., Process]]:
    """Make processes; each has to be started."""
    made: list[Process] = []

    def make(pid: int = 1, joins: bool = True) -> Process:
        made.append(Process(hub.path, pid, joins))
        return made[-1]

    yield make
    for one in made:
        one.raw.close()


@pytest.fixture
def raw(hub: Hub) -> Iterator[Raw]:
    connection = Raw(hub.path)
    yield connection
    connection.close()


@pytest.fixture
def watch(folder: Path) -> Iterator[Watch]:
    """A hub around real programs."""
    with Watch(folder) as watch:
        yield watch
