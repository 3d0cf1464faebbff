"""The versions that a handout installs: from a checkout's pins exactly what students need, and no more."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import distribution, distributions, packages_distributions
from pathlib import Path

from packaging.utils import canonicalize_name

import spinbook
from grader.gradescope.pins import LOCKS, needed
from grader.submission.python_code import MATPLOTLIB, imported
from spinbook.chapter.imports import ros_packages
from spinbook.chapter.python_code import blank_magics

#: Required by IPython and ipykernel, which do without: guesses at code that has not run, and a debugger (55 MB).
_LEFT_OUT = {"jedi", "parso", "debugpy"}

#: The extras that students install.
_STUDENTS = ("student", "colcon")

#: A magic that imports matplotlib.
_DRAWS = re.compile(rf"^\s*%({'|'.join(MATPLOTLIB)})\b", re.MULTILINE)


def imported_packages(sources: Iterable[str]) -> list[str]:
    """Return the packages, with their versions here, that cells and programs import and that nothing else needs.

    None is of ROS 2 or installed from a folder: PyPI has them all.
    """
    found = (name for source in sources for name in [*imported(blank_magics(source)), *_DRAWS.findall(source)])
    modules = {name.partition(".")[0] for name in found}
    known = packages_distributions()
    names = {canonicalize_name(name) for module in modules - ros_packages() for name in known.get(module, ())}
    others = [distribution(name) for name in sorted(names - _needed(_STUDENTS))]
    return [f"{canonicalize_name(one.name)}=={one.version}" for one in others if not one.read_text("direct_url.json")]


def students_pins(texts: bytes, packages: Sequence[str] = ()) -> list[str]:
    """Return the lines for what notebooks and checks need; none if Spinbook is not installed from a checkout.

    `texts` are what students get to read: test_msgs, which is large, is left out unless they name it. So is matplotlib
    (75 MB), unless one of `packages` needs it.
    """
    names = _needed((*_STUDENTS, "plots") if "matplotlib" in _needed_by(packages) else _STUDENTS)
    unused = set() if b"test_msgs" in texts else {"ros-test-msgs", "ros-jazzy-test-msgs"}
    return list(_pins(names - unused))


def jupyterlab_pins() -> list[str]:
    """Return the lines for what JupyterLab needs besides; without pins, its name."""
    known = _needed(_STUDENTS)
    return list(_pins(needed("jupyterlab", "") - known)) or ["jupyterlab>=4.2"]


def declared_pins(packages: Sequence[str], pinned: Sequence[str]) -> list[str]:
    """Return the lines for `packages`, such as "rosbags==0.11.9", and for what these need besides what is `pinned`.

    Without pins, pip finds what they need.
    """
    if not pinned:
        return list(packages)
    known = {canonicalize_name(re.split("[=; ]", line, maxsplit=1)[0]) for line in pinned}
    names = _needed_by(packages)
    versions: dict[str, str] = {canonicalize_name(wheel.metadata["Name"]): wheel.version for wheel in distributions()}
    return [f"{name}=={versions[name]}" for name in sorted(names - known) if name in versions]


def _needed_by(packages: Sequence[str]) -> set[str]:
    return {name for package in packages for name in needed(canonicalize_name(package.partition("==")[0]), "")}


def _needed(extras: Sequence[str]) -> set[str]:
    return {name for extra in extras for name in needed("spinbook", extra)}


def _pins(names: set[str]) -> Iterator[str]:
    root = Path(spinbook.__file__).parents[1]
    for lock in LOCKS.values():
        text = (root / lock).read_text(encoding="utf-8") if (root / lock).is_file() else ""
        for line in re.findall(r"^[A-Za-z0-9][^\\\n]*", text, re.MULTILINE):
            if re.split("[=; ]", line, maxsplit=1)[0] in names - _LEFT_OUT:
                yield line.strip()
