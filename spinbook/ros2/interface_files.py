"""The .msg, .srv and .action files of the installed packages, and how `ros2 interface show` unfolds them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from spinbook.ros2 import prefixes

KINDS = ("msg", "srv", "action")

_PRIMITIVE = re.compile(r"(bool|byte|char|float32|float64|u?int(8|16|32|64)|w?string(<=\d+)?)$")
_ARRAY = re.compile(r"\[(<=)?\d*\]$")
_SEPARATOR = "---"


def everything() -> dict[str, list[str]]:
    """Package -> its interfaces as `msg/String`, sorted; every installed package that has any."""
    markers = prefixes.resources("rosidl_interfaces", prefixes.installed())
    return {package: _read(marker) for package, marker in sorted(markers.items())}


def interfaces_of(package: str) -> list[str] | None:
    """One package's interfaces as `msg/String`, sorted; None if it has none or is not installed."""
    marker = prefixes.resources("rosidl_interfaces", prefixes.installed()).get(package)
    return None if marker is None else _read(marker)


def folder_of(package: str) -> Path:
    """The folder of an installed package's shared files."""
    prefix = prefixes.prefix_of(package, prefixes.installed())
    assert prefix is not None
    return prefix / "share" / package


def _read(marker: Path) -> list[str]:
    names = {line.strip().rpartition(".") for line in marker.read_text().splitlines()}
    return sorted({stem for stem, _, ending in names if ending in (*KINDS, "idl") and stem.split("/")[0] in KINDS})


def unfold(interface: str, *, comments: bool, nested_comments: bool, depth: int = 0) -> Iterator[str]:
    """The lines of an interface's file, each field of a message type followed by that type's lines, indented by
    a tab for each level.

    Comments and blank lines are those of the file itself, of nested files only with `nested_comments`.
    `interface` is `PACKAGE/KIND/NAME` of an installed type.
    """
    package, kind, name = interface.split("/")
    text = (folder_of(package) / kind / f"{name}.{kind}").read_text()
    for line in text.splitlines():
        raw = line.rstrip()
        shown = raw if comments else _without_comment(raw)
        if shown or comments:
            yield "\t" * depth + shown if shown else ""
        nested = _nested_type(raw, package)
        if nested is not None:
            yield from unfold(nested, comments=nested_comments, nested_comments=nested_comments, depth=depth + 1)


def _nested_type(line: str, package: str) -> str | None:
    """The message type of the field in this line, in full; None if it is another type's or no field."""
    words = _without_comment(line).split()
    if len(words) < 2 or line == _SEPARATOR:
        return None
    base = _ARRAY.sub("", words[0])
    if _PRIMITIVE.match(base) or base == _SEPARATOR:
        return None
    owner, _, name = base.rpartition("/")
    return f"{(owner or package).split('/')[0]}/msg/{name}"


def _without_comment(line: str) -> str:
    """The line up to its comment; a '#' in a quoted default is none."""
    quote = None
    for place, letter in enumerate(line):
        if quote:
            quote = None if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        elif letter == "#":
            return line[:place].strip()
    return line.strip()
