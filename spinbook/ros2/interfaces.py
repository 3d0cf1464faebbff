"""Message, service and action types by name, and the definitions that their packages installed."""

from __future__ import annotations

import difflib
import importlib
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

from interface_compiler import prefixes, shipped
from spinbook.ros2.cli import CommandError

DEFINITION_KINDS = ("msg", "srv", "action")

_PRIMITIVE = re.compile(r"(bool|byte|char|float32|float64|u?int(8|16|32|64)|w?string(<=\d+)?)$")
_ARRAY = re.compile(r"\[(<=)?\d*\]$")
_SEPARATOR = "---"


def installed_interfaces() -> dict[str, list[str]]:
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
    return sorted(
        {
            stem
            for stem, _, ending in names
            if ending in (*DEFINITION_KINDS, "idl") and stem.split("/")[0] in DEFINITION_KINDS
        }
    )


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


Kind = Literal["msg", "srv", "action"]

#: How the type of an action's feedback topic ends.
_FEEDBACK = "_FeedbackMessage"

KINDS: dict[Kind, str] = {"msg": "message", "srv": "service", "action": "action"}


def message_class(name: str) -> Any:
    """The class of a message type. Raises `CommandError` for a name that is no type installed here.

    An action's feedback topic has a type of its own, such as `turtlesim/action/RotateAbsolute_FeedbackMessage`.
    """
    action, is_feedback, _ = name.partition(_FEEDBACK)
    return action_class(action).Impl.FeedbackMessage if is_feedback else _load(name, "msg")


def service_class(name: str) -> Any:
    """The class of a service type, with `Request` and `Response`. Raises as `message_class` does."""
    return _load(name, "srv")


def action_class(name: str) -> Any:
    """The class of an action type, with `Goal`, `Result` and `Feedback`. Raises as `message_class` does."""
    return _load(name, "action")


def interface_class(name: str) -> Any:
    """The class of a message, service or action type, by its name with the middle part."""
    parts = name.split("/")
    if len(parts) != 3 or parts[1] not in KINDS:
        raise CommandError(
            f"The passed type '{name}' is invalid",
            "Expected PACKAGE/msg/NAME, PACKAGE/srv/NAME or PACKAGE/action/NAME.",
        )
    return _load(name, parts[1])


def _load(name: str, kind: Kind) -> Any:
    full = full_name(name, kind)
    package, _, short = full.split("/")
    check_installed(full)
    try:
        return getattr(importlib.import_module(f"{package}.{kind}"), short)
    except (ImportError, AttributeError) as error:
        raise CommandError(
            f"The type '{full}' has no Python code in this environment: {error}",
            f"Its package was found in {folder_of(package)}, built for another Python perhaps.",
        ) from None


def full_name(name: str, kind: Kind) -> str:
    """`std_msgs/String` -> `std_msgs/msg/String`. Raises `CommandError` for what can't be a type's name."""
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or parts[1] != kind or not all(parts):
        raise CommandError(
            f"The passed {KINDS[kind]} type is invalid: '{name}'",
            f"Expected PACKAGE/{kind}/NAME. `ros2 interface list` shows what is installed.",
        )
    return "/".join(parts)


def check_installed(full: str) -> None:
    """Raise `CommandError` where the type `PACKAGE/KIND/NAME` is not installed: how to get it, or what is like it."""
    package, kind, short = full.split("/")
    known = interfaces_of(package)
    if known is not None and f"{kind}/{short}" in known:
        return
    if known is not None:
        raise CommandError(f"The package '{package}' has no type '{kind}/{short}'.", _alike(full))
    if package in (*shipped.standard(), *shipped.optional()):
        advice = f"Compile it, once: spinbook interfaces add {package}"
    else:
        advice = _alike(full)
    raise CommandError(f"Unknown package '{package}': the type '{full}' is not installed here.", advice)


def _alike(full: str) -> str:
    everything = [f"{package}/{name}" for package, names in installed_interfaces().items() for name in names]
    short = full.rpartition("/")[2]
    alike = [name for name in everything if name.rpartition("/")[2].lower() == short.lower()]
    alike += difflib.get_close_matches(full, everything, n=3, cutoff=0.85)
    if alike:
        return f"Did you mean {' or '.join(list(dict.fromkeys(alike))[:3])}?"
    return "`ros2 interface list` shows what is installed."
