"""Rigs to run students' programs in, one for each level of isolation that this machine allows."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from sandbox_rig import Rig, reason_against

from grader.sandbox import Isolation, choose

APART = (Isolation.BUBBLEWRAP, Isolation.NAMESPACES)
CONFINED = (*APART, Isolation.LANDLOCK)


def _rigs(levels: tuple[Isolation, ...]) -> list[object]:
    return [
        pytest.param((level, rootless), id=f"{level}{'-rootless' if rootless else ''}")
        for level in levels
        for rootless in (False, True)
    ]


@pytest.fixture(scope="session")
def rigs() -> Iterator[dict[tuple[Isolation, bool], Rig]]:
    """The rigs that have been started so far in this test run."""
    started: dict[tuple[Isolation, bool], Rig] = {}
    yield started
    for rig in started.values():
        rig.close()


def _rig(request: pytest.FixtureRequest, rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    level, rootless = request.param
    reason = reason_against(level, rootless)
    if reason is not None:
        pytest.skip(f"{level}: {reason}")
    if request.param not in rigs:
        rigs[request.param] = Rig(level, rootless=rootless)
    return rigs[request.param]


@pytest.fixture(params=_rigs((*CONFINED, Isolation.NONE)))
def any_rig(request: pytest.FixtureRequest, rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig at each level, including the one that confines nothing."""
    return _rig(request, rigs)


@pytest.fixture(
    params=[pytest.param((level, False), id=str(level)) for level in (Isolation.NAMESPACES, Isolation.NONE)]
)
def either_rig(request: pytest.FixtureRequest, rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig that confines and one that does not, for what does not depend on how it is done."""
    return _rig(request, rigs)


@pytest.fixture
def strongest_rig(rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig at the strongest level that works here, the one that is chosen by default."""
    key = (choose(), False)
    if key not in rigs:
        rigs[key] = Rig(key[0], rootless=False)
    return rigs[key]


@pytest.fixture(params=_rigs(CONFINED))
def confined_rig(request: pytest.FixtureRequest, rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig at each level that keeps a student away from this machine's files."""
    return _rig(request, rigs)


@pytest.fixture(params=_rigs(APART))
def apart_rig(request: pytest.FixtureRequest, rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig at each level with namespaces: a network, processes and mounts of its own."""
    return _rig(request, rigs)
