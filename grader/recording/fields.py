"""The fields of a recorded message, by name: `message.header.frame_id`."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from functools import cache, reduce
from typing import Any

#: A second of builtin_interfaces/msg/Time (ns).
SECOND = 1_000_000_000


class Part:
    """Some fields of a message, by name. `kind` is the message's type, if known, and the path of these fields in it."""

    def __init__(self, fields: Mapping[str, Any], kind: tuple[str, ...] = ()) -> None:
        self._fields, self._kind = fields, kind

    def __getattr__(self, name: str) -> Any:
        return field_called(self._fields, name, self._kind)

    def __repr__(self) -> str:
        return f"Message({self._fields})"


class OnTopic:
    """What a whole message has besides its fields: its stamp, and fields by their full names."""

    _fields: Mapping[str, Any]

    @property
    def stamp(self) -> float:
        """Return the header's stamp in seconds."""
        return self.stamp_ns / SECOND

    @property
    def stamp_ns(self) -> int:
        """Return the header's stamp in nanoseconds. Raises AttributeError if there is none."""
        stamp = self._fields.get("header", self._fields).get("stamp")
        if stamp is None:
            raise AttributeError("stamp")  # which __getattr__ turns into the names of the fields
        return int(stamp["sec"]) * SECOND + int(stamp["nanosec"])

    def value(self, field: str) -> Any:
        """Return a field by its full name, such as `header.frame_id`."""
        from ros_in_python.field_path import field_of

        return field_of(self._fields, field)

    def by(self, key: str, field: str) -> dict[str, Any]:
        """Return two lists as a dictionary: `by("name", "velocity")` gives each joint's velocity."""
        return dict(zip(self.value(key), self.value(field), strict=False))


class NestedMessage(Part):
    """A message in a field of another one: equal to one with equal fields, which can be written as keys, too."""

    def __getitem__(self, name: str) -> Any:
        return self._fields[name]

    def __eq__(self, other: object) -> bool:
        return self._fields == (other._fields if isinstance(other, Part) else other)

    __hash__ = None  # type: ignore[assignment]  # as a dictionary


class WithFields(OnTopic):
    """A recorded message, whose own attributes take precedence over `fields` of the same name."""

    @property
    def _fields(self) -> Mapping[str, Any]:  # type: ignore[override]
        return self.__dict__["fields"]  # type: ignore[no-any-return]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # pickle and copy ask for these before there are fields
            raise AttributeError(name)
        return field_called(self.__dict__["fields"], name, (self.__dict__["type"],))


def field_called(fields: Mapping[str, Any], name: str, kind: tuple[str, ...]) -> Any:
    """Return a field by its name; nested messages, in lists as well, as `NestedMessage`.

    What a message that was sent does not give has its type's default. Raises AttributeError for a field that the type
    does not have, which suggests a similar name.
    """
    if name in fields:
        value = fields[name]
        if isinstance(value, (list, tuple)) and value and isinstance(value[0], dict):
            return [NestedMessage(part) for part in value]
        return NestedMessage(value, (*kind, name) if kind else ()) if isinstance(value, dict) else value
    if kind and name in (others := _defaults(*kind)):
        value = others[name]
        if hasattr(value, "get_fields_and_field_types"):
            return NestedMessage({}, (*kind, name))
        return value.tolist() if hasattr(value, "tolist") else value
    close = difflib.get_close_matches(name, fields, n=1)
    advice = f"Did you mean {close[0]}?" if close else f"Its fields are: {', '.join(fields) or 'none'}."
    raise AttributeError(f"a message of this type has no field {name!r}. {advice}")


@cache
def _defaults(type_name: str, *path: str) -> Mapping[str, Any]:
    """Return the default of each field of a type, or of the message at this path in it; none of an unknown one."""
    from grader.recording.types import message_class

    try:
        message = reduce(getattr, path, message_class(type_name)())
        return {name: getattr(message, name) for name in message.get_fields_and_field_types()}
    except (ImportError, AttributeError, ValueError):
        return {}
