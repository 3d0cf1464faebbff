"""The definitions that come with this package: example_interfaces, tf2_msgs and turtlesim, and optional ones.

A package is one file. Its definitions follow one another as in the schemas of an MCAP bag: a line of 80 equals signs, a
line `MSG: package/msg/Name` (or SRV, ACTION), and the text (https://mcap.dev/spec/registry#ros2msg).
"""

from __future__ import annotations

import functools
import re
from pathlib import Path

from interface_compiler.definition import Definition

_FOLDER = Path(__file__).with_name("definitions")
_HEAD = re.compile(rf"^{'=' * 80}\n[A-Z]+: (?P<package>\w+)/(?P<kind>\w+)/(?P<name>\w+)\n", re.MULTILINE)


@functools.cache
def standard() -> tuple[str, ...]:
    """Return the packages that every installation has."""
    return _packages("standard")


@functools.cache
def optional() -> tuple[str, ...]:
    """Return the packages that are compiled on request."""
    return _packages("optional")


@functools.cache
def taught() -> tuple[str, ...]:
    """Return the packages of ROS 2's tutorials: compiled on request, and defined by the courses that teach how."""
    return _packages("taught")


def known() -> tuple[str, ...]:
    """Return all packages."""
    return (*standard(), *optional(), *taught())


def how_to_add(package: str) -> str | None:
    """Return how to get one of these packages where it is not installed; None for any other package."""
    if package in known():
        return f"Compile it, once: python -m interface_compiler add {package}"
    return None


def definitions(package: str) -> list[Definition]:
    """Return the definitions of one of these packages. Raises KeyError for any other."""
    for group in ("standard", "optional", "taught"):
        if package in _packages(group):
            return _read(_FOLDER / group / f"{package}.txt")
    raise KeyError(package)


def _read(file: Path) -> list[Definition]:
    text = file.read_text(encoding="utf-8")
    heads = list(_HEAD.finditer(text))
    ends = [head.start() for head in heads[1:]] + [len(text)]
    return [
        Definition(**head.groupdict(), text=text[head.end() : end], file=file, line=text.count("\n", 0, head.end()) + 1)
        for head, end in zip(heads, ends, strict=True)
    ]


def _packages(group: str) -> tuple[str, ...]:
    return tuple(sorted(file.stem for file in (_FOLDER / group).glob("*.txt")))
