"""Runners to run students' programs in, one for each level of isolation that this machine allows."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from sandbox_runner import Runner, reason_against

from grader.sandbox import Isolation, choose

APART = (Isolation.BUBBLEWRAP, Isolation.NAMESPACES)
CONFINED = (*APART, Isolation.LANDLOCK)
#: In every `make test`, each level, and root and another user; `make soak` tries each level as both.
ALWAYS = {
    (Isolation.BUBBLEWRAP, False),
    (Isolation.BUBBLEWRAP, True),
    (Isolation.NAMESPACES, False),
    (Isolation.LANDLOCK, True),
    (Isolation.NONE, False),
}


def _rigs(levels: tuple[Isolation, ...]) -> list[object]:
    return [
        pytest.param(
            (level, rootless),
            id=f"{level}{'-rootless' if rootless else ''}",
            marks=() if (level, rootless) in ALWAYS else pytest.mark.soak,
        )
        for level in levels
        for rootless in (False, True)
    ]


@pytest.fixture(scope="session")
def runners() -> Iterator[dict[tuple[Isolation, bool], Runner]]:
    """The runners that have been started so far in this test run."""
    started: dict[tuple[Isolation, bool], Runner] = {}
    yield started
    for runner in started.values():
        runner.close()


def _runner(request: pytest.FixtureRequest, runners: dict[tuple[Isolation, bool], Runner]) -> Runner:
    level, rootless = request.param
    reason = reason_against(level, rootless)
    if reason is not None:
        pytest.skip(f"{level}: {reason}")
    if request.param not in runners:
        runners[request.param] = Runner(level, rootless=rootless)
    return runners[request.param]


@pytest.fixture(params=_rigs((*CONFINED, Isolation.NONE)))
def any_runner(request: pytest.FixtureRequest, runners: dict[tuple[Isolation, bool], Runner]) -> Runner:
    """A runner at each level, including the one that confines nothing."""
    return _runner(request, runners)


@pytest.fixture(
    params=[pytest.param((level, False), id=str(level)) for level in (Isolation.NAMESPACES, Isolation.NONE)]
)
def either_runner(request: pytest.FixtureRequest, runners: dict[tuple[Isolation, bool], Runner]) -> Runner:
    """A runner that confines and one that does not, for what does not depend on how it is done."""
    return _runner(request, runners)


@pytest.fixture
def strongest_runner(runners: dict[tuple[Isolation, bool], Runner]) -> Runner:
    """A runner at the strongest level that works here, the one that is chosen by default."""
    key = (choose(), False)
    if key not in runners:
        runners[key] = Runner(key[0], rootless=False)
    return runners[key]


@pytest.fixture(params=_rigs(CONFINED))
def confined_runner(request: pytest.FixtureRequest, runners: dict[tuple[Isolation, bool], Runner]) -> Runner:
    """A runner at each level that keeps a student away from this machine's files."""
    return _runner(request, runners)


@pytest.fixture(params=_rigs(APART))
def apart_runner(request: pytest.FixtureRequest, runners: dict[tuple[Isolation, bool], Runner]) -> Runner:
    """A runner at each level with namespaces: a network, processes and mounts of its own."""
    return _runner(request, runners)
