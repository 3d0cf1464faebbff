"""Between ROS messages and plain fields."""

from __future__ import annotations

import array
import importlib
from typing import Any

from grader.recording.recording import Fields


def message_class(type_name: str) -> Any:
    """The Python class of `package/msg/Name`. Raises ImportError or AttributeError where there is none."""
    package, kind, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)


def to_fields(message: Any) -> Fields:
    """The fields of a ROS message as plain data."""
    return {name: _plain(getattr(message, name)) for name in message.get_fields_and_field_types()}


def to_message(type_name: str, fields: Fields) -> Any:
    """A ROS message of that type with these fields; fields not given keep their defaults."""
    return _filled(message_class(type_name)(), fields)


def _filled(message: Any, fields: Fields) -> Any:
    for name, value in fields.items():
        if isinstance(value, dict):
            _filled(getattr(message, name), value)
        else:
            setattr(message, name, value)
    return message


def _plain(value: Any) -> Any:
    if hasattr(value, "get_fields_and_field_types"):
        return to_fields(value)
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    if isinstance(value, (list, tuple, array.array)) or hasattr(value, "tolist"):
        return [_plain(item) for item in (value.tolist() if hasattr(value, "tolist") else value)]
    return value
