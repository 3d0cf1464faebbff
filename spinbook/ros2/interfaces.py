"""Message, service and action types by name: from `sensor_msgs/msg/JointState` to the class."""

from __future__ import annotations

import difflib
import importlib
from typing import Any, Literal

from interface_compiler import shipped
from spinbook.ros2 import interface_files
from spinbook.ros2.refusal import Refusal

Kind = Literal["msg", "srv", "action"]

#: How the type of an action's feedback topic ends.
_FEEDBACK = "_FeedbackMessage"

KINDS: dict[Kind, str] = {"msg": "message", "srv": "service", "action": "action"}


def message_class(name: str) -> Any:
    """The class of a message type. Raises `Refusal` for a name that is no type installed here.

    An action's feedback topic has a type of its own, such as `turtlesim/action/RotateAbsolute_FeedbackMessage`.
    """
    action, is_feedback, _ = name.partition(_FEEDBACK)
    return action_class(action).Impl.FeedbackMessage if is_feedback else _load(name, "msg")


def service_class(name: str) -> Any:
    """The class of a service type, with `Request` and `Response`. Raises `Refusal` as `message_class` does."""
    return _load(name, "srv")


def action_class(name: str) -> Any:
    """The class of an action type, with `Goal`, `Result` and `Feedback`. Raises `Refusal` as `message_class` does."""
    return _load(name, "action")


def interface_class(name: str) -> Any:
    """The class of a message, service or action type, by its name with the middle part."""
    parts = name.split("/")
    if len(parts) != 3 or parts[1] not in KINDS:
        raise Refusal(
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
        raise Refusal(
            f"The type '{full}' has no Python code in this environment: {error}",
            f"Its package was found in {interface_files.folder_of(package)}, built for another Python perhaps.",
        ) from None


def full_name(name: str, kind: Kind) -> str:
    """`std_msgs/String` -> `std_msgs/msg/String`. Raises `Refusal` for what can't be a type's name."""
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or parts[1] != kind or not all(parts):
        raise Refusal(
            f"The passed {KINDS[kind]} type is invalid: '{name}'",
            f"Expected PACKAGE/{kind}/NAME. `ros2 interface list` shows what is installed.",
        )
    return "/".join(parts)


def check_installed(full: str) -> None:
    """Raise `Refusal` where the type `PACKAGE/KIND/NAME` is not installed: how to get it, or what is like it."""
    package, kind, short = full.split("/")
    known = interface_files.interfaces_of(package)
    if known is not None and f"{kind}/{short}" in known:
        return
    if known is not None:
        raise Refusal(f"The package '{package}' has no type '{kind}/{short}'.", _alike(full))
    if package in (*shipped.standard(), *shipped.optional()):
        advice = f"Compile it, once: spinbook interfaces add {package}"
    else:
        advice = _alike(full)
    raise Refusal(f"Unknown package '{package}': the type '{full}' is not installed here.", advice)


def _alike(full: str) -> str:
    everything = [f"{package}/{name}" for package, names in interface_files.everything().items() for name in names]
    short = full.rpartition("/")[2]
    alike = [name for name in everything if name.rpartition("/")[2].lower() == short.lower()]
    alike += difflib.get_close_matches(full, everything, n=3, cutoff=0.85)
    if alike:
        return f"Did you mean {' or '.join(list(dict.fromkeys(alike))[:3])}?"
    return "`ros2 interface list` shows what is installed."
