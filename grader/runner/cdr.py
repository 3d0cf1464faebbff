"""Converts between serialized messages and plain fields."""

from __future__ import annotations

from typing import Any

from rclpy.serialization import deserialize_message, serialize_message

from grader.recording.events import Fields
from grader.runner.message import filled, to_fields
from grader.runner.program import CannotContinue


def serialized(kind: Any, fields: Fields) -> bytes:
    """Return a message, request or response of the class `kind` with these fields, as bytes."""
    content: bytes = serialize_message(filled(kind(), fields))
    return content


def deserialized(cdr: bytes, kind: Any) -> Any:
    """Return bytes from a program as a message of the class `kind`. Raises `CannotContinue` if they are not one."""
    try:
        return deserialize_message(cdr, kind)
    except Exception as error:  # made-up bytes can raise anything
        raise CannotContinue("over-limit", f"Your node published bytes that are not a message: {error}") from None


def fields_of(cdr: bytes, kind: Any) -> Fields:
    """Return the same as plain fields."""
    return to_fields(deserialized(cdr, kind))
