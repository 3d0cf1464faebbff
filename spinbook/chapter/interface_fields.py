"""The fields of messages, and of the parts of services and actions, read from the definitions that are installed."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from types import MappingProxyType

from interface_compiler import prefixes

#: Kind -> the parts that `---` separates.
PARTS = {"msg": ("",), "srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}
_FIELD = re.compile(r"([\w/]+)((?:<=\d+)?)((?:\[(?:<=)?\d*\])?)\s+(\w+)\s*(=?)")
_BASIC = re.compile(r"(bool|byte|char|float32|float64|u?int(8|16|32|64)|w?string)$")
_SHORT = {"Header": "std_msgs/Header", "time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}


@dataclass(frozen=True)
class FieldType:
    """The type of a field: `base` is such as `float64` or `geometry_msgs/msg/Point`."""

    base: str
    is_list: bool = False

    @property
    def is_message(self) -> bool:
        """Whether it is a message, which has fields of its own."""
        return "/" in self.base

    def __str__(self) -> str:
        return f"{self.base}[]" if self.is_list else self.base


@dataclass(frozen=True)
class WrongField:
    """A field that does not exist, a value of another type, or a callback without its answer.

    `line` counts from 1 within the program.
    """

    line: int
    problem: str
    fix: str


@dataclass(frozen=True)
class InterfaceFields:
    """The fields of a message, or of one part of a service or action. `name` is such as `Trigger.Response`."""

    name: str
    fields: Mapping[str, FieldType]
    constants: frozenset[str]


_OWN: ContextVar[Mapping[str, str]] = ContextVar("own definitions", default=MappingProxyType({}))


@contextmanager
def own_definitions(texts: Mapping[str, str]) -> Iterator[None]:
    """Let `fields_of` also know these definitions, which need not be compiled: `my_interfaces/msg/Pose` -> text."""
    token = _OWN.set(texts)
    try:
        yield
    finally:
        _OWN.reset(token)


def fields_of(interface: str, part: str = "") -> InterfaceFields | None:
    """Return the fields of `std_msgs/msg/String`, or of a part such as `Request`; None if its definition is unknown."""
    package, kind, name = interface.split("/")
    text = _OWN.get().get(interface) or _definitions(package).get(f"{kind}/{name}.{kind}")
    return _fields(interface, part, text) if text is not None and part in PARTS[kind] else None


@functools.lru_cache(maxsize=512)
def _fields(interface: str, part: str, text: str) -> InterfaceFields:
    package, kind, name = interface.split("/")
    section = re.split(r"^---.*$", text, flags=re.MULTILINE)[PARTS[kind].index(part) :][:1]
    return _read(f"{name}.{part}" if part else name, section[0] if section else "", package)


@functools.cache
def _definitions(package: str) -> Mapping[str, str]:
    prefix = prefixes.prefix_of(package, prefixes.installed())
    return prefixes.definitions_of(package, prefix) if prefix else {}


def _read(name: str, text: str, package: str) -> InterfaceFields:
    fields: dict[str, FieldType] = {}
    constants: set[str] = set()
    for line in text.splitlines():
        if match := _FIELD.match(line.strip()):
            base, _, array, field, is_constant = match.groups()
            if is_constant:
                constants.add(field)
            else:
                fields[field] = FieldType(_full(base, package), bool(array))
    return InterfaceFields(name, fields, frozenset(constants))


def _full(base: str, package: str) -> str:
    if _BASIC.match(base):
        return base
    owner, _, name = _SHORT.get(base, base).rpartition("/")
    return f"{(owner or package).partition('/')[0]}/msg/{name}"
