"""The versions that a handout installs: from a checkout's pins exactly what students need, and no more."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import distributions
from pathlib import Path

from packaging.utils import canonicalize_name

import spinbook
from grader.gradescope.pins import LOCKS, needed
from grader.submission.python_code import MATPLOTLIB

#: Required by IPython and ipykernel, which do without: guesses at code that has not run, and a debugger (55 MB).
_LEFT_OUT = {"jedi", "parso", "debugpy"}

_IMPORTS_MATPLOTLIB = re.compile(rf"^\s*(import\b|from\b|%)[^\n#]*\b({'|'.join(MATPLOTLIB)})\b", re.MULTILINE)


def imports_matplotlib(sources: Iterable[str]) -> bool:
    """Return whether any of these cells and programs does: matplotlib takes 75 MB, and nothing else needs it."""
    return any(map(_IMPORTS_MATPLOTLIB.search, sources))


def students_pins(texts: bytes, *, plots: bool = False) -> list[str]:
    """Return the lines for what notebooks and checks need; none if Spinbook is not installed from a checkout.

    `texts` are what students get to read: test_msgs, which is large, is left out unless they name it. With `plots`
    matplotlib is among them.
    """
    names = _needed(("student", "colcon", "plots") if plots else ("student", "colcon"))
    unused = set() if b"test_msgs" in texts else {"ros-test-msgs", "ros-jazzy-test-msgs"}
    return list(_pins(names - unused))


def jupyterlab_pins() -> list[str]:
    """Return the lines for what JupyterLab needs besides; without pins, its name."""
    known = _needed(("student", "colcon"))
    return list(_pins(needed("jupyterlab", "") - known)) or ["jupyterlab>=4.2"]


def declared_pins(packages: Sequence[str], pinned: Sequence[str]) -> list[str]:
    """Return the lines for `packages`, such as "rosbags==0.11.9", and for what these need besides what is `pinned`.

    Without pins, pip finds what they need.
    """
    if not pinned:
        return list(packages)
    known = {canonicalize_name(re.split("[=; ]", line, maxsplit=1)[0]) for line in pinned}
    names = {name for package in packages for name in needed(canonicalize_name(package.partition("==")[0]), "")}
    versions: dict[str, str] = {canonicalize_name(wheel.metadata["Name"]): wheel.version for wheel in distributions()}
    return [f"{name}=={versions[name]}" for name in sorted(names - known) if name in versions]


def _needed(extras: Sequence[str]) -> set[str]:
    return {name for extra in extras for name in needed("spinbook", extra)}


def _pins(names: set[str]) -> Iterator[str]:
    root = Path(spinbook.__file__).parents[1]
    for lock in LOCKS.values():
        text = (root / lock).read_text(encoding="utf-8") if (root / lock).is_file() else ""
        for line in re.findall(r"^[A-Za-z0-9][^\\\n]*", text, re.MULTILINE):
            if re.split("[=; ]", line, maxsplit=1)[0] in names - _LEFT_OUT:
                yield line.strip()
