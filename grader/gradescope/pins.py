"""The versions of everything that an autograder installs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Set
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

#: The distribution that an autograder installs, with ROS 2 from PyPI.
NAME, EXTRA = "spinbook", "grade"

#: File of pins -> a checkout's, for every Python. Two, so that one is installed while the other is downloaded.
LOCKS = {"pins.txt": "constraints.txt", "pins-ros.txt": "constraints-ros.txt"}

#: What notebooks and some students' programs draw with. An autograder installs it for programs that name it.
PLOTS, PLOTS_PINS = "matplotlib", "pins-plots.txt"

#: Needed only by ROS 2's own code generators, and to build packages: neither is done there.
NOT_USED = {"empy", "setuptools"}

#: The versions of Python that its container may have.
PYTHONS = ("3.10", "3.11", "3.12", "3.13", "3.14")

#: What the versions for Python 3.10 need, and those that are installed here do not.
OF_OTHER_VERSIONS = {"python-dateutil": ("six",), "ipython": ("decorator",)}


def pins() -> str:
    """Return the installed versions of everything that is needed, a line such as `numpy==2.3.1` for each."""
    names = sorted((needed() | needed(PLOTS, "")) - {NAME})
    return "".join(f"{pinned(name)}\n" for name in names if _installed(name))


def pinned(name: str) -> str:
    """Return what pip is to install: the version that is here, or any if none is, as where ROS 2 comes from Debian."""
    distribution = _installed(name)
    return f"{name}=={distribution.version}" if distribution else name


def hashed_pins(lock: Path, needs: Set[str]) -> str:
    """Return what a file of pins with hashes (pip, "Secure installs") says of what `needs` contains and is used."""
    names = needs - NOT_USED
    entries = re.split(r"^(?=[A-Za-z0-9])", lock.read_text(), flags=re.MULTILINE)
    return "".join(entry for entry in entries if canonicalize_name(re.split("[=; ]", entry, maxsplit=1)[0]) in names)


def needed(name: str = NAME, extra: str = EXTRA) -> set[str]:
    """Return the names of everything that is needed on any of these Pythons, as far as it is installed here."""
    waiting, done = [(name, frozenset({extra}))], set[tuple[str, frozenset[str]]]()
    while waiting:
        one = waiting.pop()
        if one not in done:
            done.add(one)
            waiting += _requirements(*one)
            waiting += [(other, frozenset()) for other in OF_OTHER_VERSIONS.get(one[0], ())]
    return {name for name, _ in done}


def _requirements(name: str, extras: frozenset[str]) -> Iterator[tuple[str, frozenset[str]]]:
    distribution = _installed(name)
    for text in (distribution.requires if distribution else None) or ():
        requirement = Requirement(text)
        if any(_applies(requirement, extra, python) for extra in ("", *extras) for python in PYTHONS):
            yield canonicalize_name(requirement.name), frozenset(requirement.extras)


def _applies(requirement: Requirement, extra: str, python: str) -> bool:
    environment = {"extra": extra, "python_version": python, "python_full_version": f"{python}.0"}
    return requirement.marker is None or requirement.marker.evaluate(environment)


def _installed(name: str) -> metadata.Distribution | None:
    try:
        return metadata.distribution(name)
    except metadata.PackageNotFoundError:
        return None
