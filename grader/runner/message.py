"""Between ROS messages and plain fields."""

from __future__ import annotations

import array
import importlib
import re
from functools import cache
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message

from grader.recording.recording import Fields
from grader.runner.stopped import Stopped

_LIST = re.compile(r"sequence<(?P<sequence>[^,>]+)(, \d+)?>|(?P<array>.+)\[\d+\]")


@cache
def message_class(type_name: str) -> Any:
    """The Python class of `package/msg/Name`. Raises ImportError or AttributeError where there is none."""
    package, kind, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)


def to_fields(message: Any) -> Fields:
    """The fields of a ROS message as plain data."""
    return {name: _plain(getattr(message, name)) for name in message.get_fields_and_field_types()}


def to_message(type_name: str, fields: Fields) -> Any:
    """A ROS message of that type with these fields; fields not given keep their defaults."""
    return filled(message_class(type_name)(), fields)


def filled(message: Any, fields: Fields) -> Any:
    """The message itself, with these fields set."""
    for name, value in fields.items():
        if isinstance(value, dict):
            filled(getattr(message, name), value)
        elif isinstance(value, (list, tuple)) and value and isinstance(value[0], dict):
            kind = _element_class(message, name)
            setattr(message, name, [filled(kind(), one) for one in value])
        else:
            setattr(message, name, value)
    return message


def serialized(kind: Any, fields: Fields) -> bytes:
    """A message, request or response of the class `kind` with these fields, as bytes."""
    content: bytes = serialize_message(filled(kind(), fields))
    return content


def deserialized(cdr: bytes, kind: Any) -> Any:
    """What a program sent, as a message of the class `kind`. Raises `Stopped` for bytes that are none."""
    try:
        return deserialize_message(cdr, kind)
    except Exception as error:  # whatever made-up bytes lead to
        raise Stopped("over-limit", f"Your node published bytes that are no message: {error}") from None


def fields_of(cdr: bytes, kind: Any) -> Fields:
    """What a program sent, as plain fields. Raises `Stopped` for bytes that are no message of the class `kind`."""
    try:
        return to_fields(deserialize_message(cdr, kind))
    except Exception as error:  # whatever made-up bytes lead to
        raise Stopped("over-limit", f"Your node published bytes that are no message: {error}") from None


def _element_class(message: Any, field: str) -> Any:
    found = _LIST.fullmatch(message.get_fields_and_field_types()[field])
    assert found
    package, _, name = (found["sequence"] or found["array"]).partition("/")
    return message_class(f"{package}/msg/{name}")


def _plain(value: Any) -> Any:
    if hasattr(value, "get_fields_and_field_types"):
        return to_fields(value)
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    if isinstance(value, (list, tuple, array.array)) or hasattr(value, "tolist"):
        return [_plain(item) for item in (value.tolist() if hasattr(value, "tolist") else value)]
    return value
