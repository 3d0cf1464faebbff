"""Converts between ROS messages and plain fields.

It is independent of runs, because pages load it without the rest of the grader.
"""

from __future__ import annotations

import functools
import re
from array import array
from typing import Any

from grader.recording.arrays import CODES, LONG, LongArray, plain_array
from grader.recording.events import Fields
from grader.recording.types import message_class as message_class

_LIST = re.compile(r"sequence<(?P<sequence>[^,>]+)(, \d+)?>|(?P<array>.+)\[\d+\]")


def to_fields(message: Any) -> Fields:
    """Return the fields of a ROS message as plain data."""
    kind: Any = type(message)
    return {name: _plain(getattr(message, name)) for name in _types(kind)}


def filled(message: Any, fields: Fields) -> Any:
    """Set these fields of the message, and return the message itself."""
    for name, value in fields.items():
        if isinstance(value, dict):
            filled(getattr(message, name), value)
        elif isinstance(value, (list, tuple)) and value and isinstance(value[0], dict):
            element = _element_class(message, name)
            setattr(message, name, [filled(element(), one) for one in value])
        else:
            kind: Any = type(message)
            setattr(message, name, _as_rclpy_has_it(_types(kind).get(name, ""), value))
    return message


@functools.cache
def _types(kind: Any) -> dict[str, str]:
    """Return the types of a message type's fields; cached, because the type makes a new copy each time."""
    return dict(kind.get_fields_and_field_types())


@functools.cache
def _element_type(type_name: str) -> str:
    """Return the type of a list's elements; "" for what is no list."""
    found = _LIST.fullmatch(type_name)
    return found["sequence"] or found["array"] if found else ""


def _element_class(message: Any, field: str) -> Any:
    kind: Any = type(message)
    package, _, name = _element_type(_types(kind)[field]).partition("/")
    return message_class(f"{package}/msg/{name}")


def _as_rclpy_has_it(type_name: str, value: Any) -> Any:
    """Return a plain value as a field of that type takes it: `byte` is one byte, and `byte[]` a list of these."""
    of = _element_type(type_name)
    if "octet" in (of, type_name):
        return [_as_byte(one) for one in value] if of else _as_byte(value)
    if isinstance(value, LongArray):
        # With the field's own type code it is taken as it is; otherwise each number would be looked at.
        return value.tolist() if type_name.endswith("]") else array("f" if of == "float" else CODES[of], value)
    return value


def _as_byte(value: Any) -> Any:
    return bytes([value]) if isinstance(value, int) else value


def _plain(value: Any) -> Any:
    if type(value) in _PLAIN:
        return value
    if hasattr(value, "get_fields_and_field_types"):
        return to_fields(value)
    if isinstance(value, (bytes, bytearray)):  # a byte
        return value[0] if len(value) == 1 else list(value)
    if isinstance(value, array):
        return plain_array(_exact(value.typecode), value)
    if hasattr(value, "tolist"):  # numpy's, for arrays of a fixed length
        return _plain_list(value.tolist())
    if isinstance(value, (list, tuple)):
        return _plain_list([_plain(item) for item in value])
    return value


def _exact(code: str) -> str:
    return "d" if code == "f" else code


def _plain_list(values: list[Any]) -> Any:
    """Return a long list of numbers of one type as an array."""
    if len(values) < LONG or type(values[0]) not in (int, float) or len(set(map(type, values))) > 1:
        return values
    return plain_array("d" if isinstance(values[0], float) else "q", values)


#: Most values in messages, which are plain data already.
_PLAIN = (float, str, int, bool)
