"""The fields of a recorded message, by name: `message.header.frame_id`."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any


class Part:
    """Some fields of a message, by name."""

    def __init__(self, fields: Mapping[str, Any]) -> None:
        self._fields = fields

    def __getattr__(self, name: str) -> Any:
        return field_called(self._fields, name)

    def __repr__(self) -> str:
        return f"Message({self._fields})"


class NestedMessage(Part):
    """A message in a field of another one: equal to one with equal fields, which can be written as keys, too."""

    def __getitem__(self, name: str) -> Any:
        return self._fields[name]

    def __eq__(self, other: object) -> bool:
        return self._fields == (other._fields if isinstance(other, Part) else other)

    __hash__ = None  # type: ignore[assignment]  # as a dictionary


class WithFields:
    """A recorded message, whose own attributes take precedence over `fields` of the same name."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # pickle and copy ask for these before there are fields
            raise AttributeError(name)
        return field_called(self.__dict__["fields"], name)


def field_called(fields: Mapping[str, Any], name: str) -> Any:
    """Return a field by its name; nested messages, in lists as well, as `NestedMessage`.

    Raises AttributeError, which suggests a similar name.
    """
    if name in fields:
        value = fields[name]
        if isinstance(value, (list, tuple)) and value and isinstance(value[0], dict):
            return [NestedMessage(one) for one in value]
        return NestedMessage(value) if isinstance(value, dict) else value
    close = difflib.get_close_matches(name, fields, n=1)
    advice = f"Did you mean {close[0]}?" if close else f"Its fields are: {', '.join(fields) or 'none'}."
    raise AttributeError(f"a message of this type has no field {name!r}. {advice}")
