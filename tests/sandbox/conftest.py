"""Rigs to run students' programs in, one for each level of isolation that this machine allows."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from sandbox_rig import Rig

from grader.sandbox import Isolation, available, choose

APART = (Isolation.BUBBLEWRAP, Isolation.NAMESPACES)
CONFINED = (*APART, Isolation.LANDLOCK)
_ROOT = Path(__file__).parents[2]


@cache
def reason_against(level: Isolation, rootless: bool) -> str | None:
    """Why a level cannot be tested here; None if it can."""
    if not rootless:
        return available()[level]
    if os.geteuid() != 0:
        return "the tests are not run as root: what is tested without root is the same as the case above"
    code = (
        f"import sys; sys.path[:0] = [{str(Path(__file__).parent)!r}, {str(_ROOT)!r}]\n"
        "from sandbox_rig import become_nobody\n"
        "become_nobody()\n"
        "from grader.sandbox import Isolation, available, choose\n"
        f"print(available()[Isolation({level.value!r})] or '')"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    return said.stdout.strip() or said.stderr.strip() or None


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
    """A rig at each level, also at the one that confines nothing."""
    return _rig(request, rigs)


@pytest.fixture(
    params=[pytest.param((level, False), id=str(level)) for level in (Isolation.NAMESPACES, Isolation.NONE)]
)
def either_rig(request: pytest.FixtureRequest, rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig that confines and one that does not, for what does not depend on how it is done."""
    return _rig(request, rigs)


@pytest.fixture
def strongest_rig(rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig at the strongest level that works here, the one that is chosen without a wish."""
    key = (choose(), False)
    if key not in rigs:
        rigs[key] = Rig(key[0], rootless=False)
    return rigs[key]


@pytest.fixture(params=_rigs(CONFINED))
def confined_rig(request: pytest.FixtureRequest, rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig at each level that keeps a student off this machine's files."""
    return _rig(request, rigs)


@pytest.fixture(params=_rigs(APART))
def apart_rig(request: pytest.FixtureRequest, rigs: dict[tuple[Isolation, bool], Rig]) -> Rig:
    """A rig at each level with namespaces: a network, processes and mounts of its own."""
    return _rig(request, rigs)
