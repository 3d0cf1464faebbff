"""Converts between ROS messages and plain fields.

It is independent of runs, because pages load it without the rest of the grader.
"""

from __future__ import annotations

import functools
import re
from typing import Any

from grader.recording.recording import Fields
from grader.recording.types import message_class as message_class

_LIST = re.compile(r"sequence<(?P<sequence>[^,>]+)(, \d+)?>|(?P<array>.+)\[\d+\]")


def to_fields(message: Any) -> Fields:
    """Return the fields of a ROS message as plain data."""
    kind: Any = type(message)
    return {name: _plain(getattr(message, name)) for name in _names(kind)}


@functools.cache
def _names(kind: Any) -> tuple[str, ...]:
    """Return the names of a message type's fields; cached, because the type makes a new copy each time."""
    return tuple(kind.get_fields_and_field_types())


def to_message(type_name: str, fields: Fields) -> Any:
    """Return a ROS message of that type with these fields; fields not given keep their defaults."""
    return filled(message_class(type_name)(), fields)


def filled(message: Any, fields: Fields) -> Any:
    """Set these fields of the message, and return the message itself."""
    for name, value in fields.items():
        if isinstance(value, dict):
            filled(getattr(message, name), value)
        elif isinstance(value, (list, tuple)) and value and isinstance(value[0], dict):
            kind = _element_class(message, name)
            setattr(message, name, [filled(kind(), one) for one in value])
        else:
            setattr(message, name, value)
    return message


def _element_class(message: Any, field: str) -> Any:
    found = _LIST.fullmatch(message.get_fields_and_field_types()[field])
    assert found
    package, _, name = (found["sequence"] or found["array"]).partition("/")
    return message_class(f"{package}/msg/{name}")


def _plain(value: Any) -> Any:
    if type(value) in _PLAIN:
        return value
    if hasattr(value, "get_fields_and_field_types"):
        return to_fields(value)
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    if hasattr(value, "tolist"):  # an array of numbers, Python's or numpy's
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value


#: Most values in messages, which are plain data already.
_PLAIN = (float, str, int, bool)
