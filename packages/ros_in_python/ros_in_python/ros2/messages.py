"""Messages as text, and messages from text."""

from __future__ import annotations

import array
import importlib
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import yaml
from rosidl_parser import definition

from ros_in_python.ros2.cli import CommandError


@dataclass(frozen=True)
class Brevity:
    """What is left out: elements and letters after `length` (None: nothing), every array, every string."""

    length: int | None = None
    no_arrays: bool = False
    no_strings: bool = False


WHOLE = Brevity()


class UnknownFieldError(CommandError):
    """A message does not have this field."""


class _Dumper(yaml.Dumper):
    """Mappings in the order of the fields, in block style as far as they can be, as the real command has them."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _mapping(dumper: _Dumper, data: dict[str, Any]) -> yaml.MappingNode:
    pairs = [(dumper.represent_data(key), dumper.represent_data(value)) for key, value in data.items()]
    return yaml.MappingNode("tag:yaml.org,2002:map", pairs)


_Dumper.add_representer(dict, _mapping)


def to_yaml(message: Any, brevity: Brevity = WHOLE, *, flow_style: bool = False) -> str:
    """Return a message as YAML, with a line end. `flow_style` puts arrays on one line."""
    text: str = yaml.dump(
        to_dict(message, brevity), Dumper=_Dumper, allow_unicode=True, width=sys.maxsize, default_flow_style=flow_style
    )
    return text


def to_csv(message: Any, brevity: Brevity = WHOLE) -> str:
    """Return a message's values, including nested ones, separated by commas."""
    types = message.get_fields_and_field_types()
    return _join(
        _csv(getattr(message, name), slot, brevity) for name, slot in zip(types, message.SLOT_TYPES, strict=True)
    )


def _join(parts: Iterable[str]) -> str:
    """Join the parts with commas; like the real command, without one before the first that is not empty."""
    text = ""
    for part in parts:
        text += f",{part}" if text else part
    return text


def is_message(value: Any) -> bool:
    """Return whether this is a message, and not a number, a text or an array."""
    return hasattr(value, "get_fields_and_field_types")


def to_dict(message: Any, brevity: Brevity = WHOLE) -> dict[str, Any]:
    """Return a message's fields as plain data: numbers, texts, lists and dictionaries."""
    names = message.get_fields_and_field_types()
    return {
        name: _plain(getattr(message, name), slot, brevity)
        for name, slot in zip(names, message.SLOT_TYPES, strict=True)
    }


def _plain(value: Any, slot: Any, brevity: Brevity) -> Any:
    """Return a field's value as plain data for YAML."""
    if isinstance(value, bytes):
        return _shorten("".join(map(chr, value)), brevity)
    if isinstance(value, str):
        return f"<string length: <{len(value)}>>" if brevity.no_strings else _shorten(value, brevity)
    if isinstance(value, (list, tuple, array.array, np.ndarray)):
        if brevity.no_arrays and slot is not None:
            return _abbreviation(value, slot)
        shown = value if brevity.length is None else value[: brevity.length]
        return [_plain(item, None, brevity) for item in shown] + (["..."] if len(shown) < len(value) else [])
    if isinstance(value, np.generic):
        return value.item()
    return to_dict(value, brevity) if is_message(value) else value


def _csv(value: Any, slot: Any, brevity: Brevity) -> str:
    if isinstance(value, (list, tuple, array.array, np.ndarray)):
        if brevity.no_arrays and slot is not None:
            return _abbreviation(value, slot)
        return _join(_csv_items(value, brevity))
    if isinstance(value, str):
        return f"<string length: <{len(value)}>>" if brevity.no_strings else _shorten(value, brevity)
    if isinstance(value, bytes):
        long = brevity.length is not None and len(value) > brevity.length
        return str(value[: brevity.length] + b"..." if long else value)
    return to_csv(value, brevity) if is_message(value) else str(value)


def _csv_items(values: Any, brevity: Brevity) -> Iterable[str]:
    for place, item in enumerate(values):
        if brevity.length is not None and place >= brevity.length:
            yield "..."
            return
        yield _csv(item, None, brevity)


def _shorten(text: str, brevity: Brevity) -> str:
    if brevity.length is None or len(text) <= brevity.length:
        return text
    return text[: brevity.length] + "..."


def _abbreviation(values: Any, slot: Any) -> str:
    """Return what `--no-arr` prints instead of an array."""
    element = _type_name(slot.value_type)
    if isinstance(slot, definition.Array):
        return f"<array type: {element}[{slot.size}]>"
    if isinstance(slot, definition.BoundedSequence):
        return f"<sequence type: {element}[{slot.maximum_size}], length: {len(values)}>"
    return f"<sequence type: {element}, length: {len(values)}>"


def _type_name(slot: Any) -> str:
    if isinstance(slot, definition.BasicType):
        return str(slot.typename)
    if isinstance(slot, definition.AbstractString):
        return "string"
    if isinstance(slot, definition.AbstractWString):
        return "wstring"
    if isinstance(slot, definition.NamespacedType):
        return "/".join(slot.namespaced_name())
    return str(getattr(slot, "name", "unknown"))


#: Sets a field that was given as 'now' or 'auto' to a builtin_interfaces/msg/Time.
SetStamp = Callable[[Any], None]

_LISTED = 12


def read_values(text: str, what: str) -> dict[str, Any]:
    """Read YAML text as a mapping. Raises `CommandError` if it is not YAML, or not a mapping."""
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f" at its letter {mark.column + 1}" if mark is not None else ""
        raise CommandError(
            f"The passed {what} is not YAML{place}: {getattr(error, 'problem', None) or error}",
            "Quote it for the shell, and put a blank after each colon and comma: '{linear: {x: 2.0}}'",
        ) from None
    if not isinstance(values, dict):
        raise CommandError(
            "The passed value needs to be a dictionary in YAML format",
            f"Found: {text!r}. Expected FIELD: VALUE in braces, as in '{{data: hello}}', with a blank after the colon.",
        )
    return values


def fill(message: Any, values: dict[str, Any], *, stamps: bool = False) -> list[SetStamp]:
    """Set a message's fields from plain values; fields not named keep their defaults.

    With `stamps`, a header given as `auto` and a time given as `now` are left for the returned setters. Raises
    `CommandError` for a field that is not there and for a value that is not of the field's type.
    """
    filling = _MessageFiller(stamps)
    filling.message(message, values, "")
    return filling.setters


class _MessageFiller:
    def __init__(self, stamps: bool) -> None:
        self.stamps = stamps
        self.setters: list[SetStamp] = []

    def message(self, message: Any, values: Any, path: str) -> None:
        if not isinstance(values, dict):
            raise _wrong(path, values, f"the fields of {type_name(message)}: {field_names(message)}")
        types = message.get_fields_and_field_types()
        slots = dict(zip(types, message.SLOT_TYPES, strict=True))
        for name, value in values.items():
            if name not in slots:
                raise _unknown(message, name, path)
            self.field(message, name, slots[name], value, f"{path}.{name}" if path else name)

    def field(self, message: Any, name: str, slot: Any, value: Any, path: str) -> None:
        present = getattr(message, name)
        if isinstance(slot, definition.NamespacedType):
            full = "/".join(slot.namespaced_name())
            if self.stamps and value == "auto" and full == "std_msgs/msg/Header":
                self.setters.append(partial(setattr, present, "stamp"))
            elif self.stamps and value == "now" and full == "builtin_interfaces/msg/Time":
                self.setters.append(partial(setattr, message, name))
            else:
                self.message(present, value, path)
            return
        kind = message.get_fields_and_field_types()[name]
        is_array = isinstance(slot, definition.AbstractNestedType)
        setattr(message, name, self.array(slot, value, path, kind) if is_array else _scalar(slot, value, path))

    def array(self, slot: Any, value: Any, path: str, kind: str) -> list[Any]:
        if isinstance(value, (bytes, bytearray)):
            value = list(value)
        if not isinstance(value, list):
            raise _wrong(path, value, f"{kind}, a list as in [a, b]")
        _check_length(slot, value, path)
        element = slot.value_type
        places = [f"{path}[{place}]" for place in range(len(value))]
        if isinstance(element, definition.NamespacedType):
            return [self.element(element, item, place) for item, place in zip(value, places, strict=True)]
        return [_scalar(element, item, place) for item, place in zip(value, places, strict=True)]

    def element(self, slot: Any, value: Any, path: str) -> Any:
        *packages, name = slot.namespaced_name()
        message = getattr(importlib.import_module(".".join(packages)), name)()
        self.message(message, value, path)
        return message


def _check_length(slot: Any, value: list[Any], path: str) -> None:
    if isinstance(slot, definition.Array) and len(value) != slot.size:
        raise _wrong(path, value, f"exactly {slot.size} values")
    if isinstance(slot, definition.BoundedSequence) and len(value) > slot.maximum_size:
        raise _wrong(path, value, f"at most {slot.maximum_size} values")


def _scalar(slot: Any, value: Any, path: str) -> Any:
    """Return a number, text or truth value in the type of its field, converted if nothing is lost."""
    if isinstance(slot, (definition.AbstractString, definition.AbstractWString)):
        return _text(slot, value, path)
    name = slot.typename
    if name == "boolean":
        if isinstance(value, (bool, int)) and value in (0, 1):
            return bool(value)
        raise _wrong(path, value, "boolean: true or false")
    if name == "octet":
        return _octet(value, path)
    if name in _INTEGERS:
        return _integer(name, value, path)
    try:
        return float(value)
    except (TypeError, ValueError):
        raise _wrong(path, value, f"a number ({name})") from None


def _text(slot: Any, value: Any, path: str) -> str:
    if not isinstance(value, (str, int, float, bool)):
        raise _wrong(path, value, "a text (string)")
    text = str(value)
    most = getattr(slot, "maximum_size", None)
    if most is not None and len(text) > most:
        raise _wrong(path, value, f"a text of at most {most} letters")
    return text


# The wheels' messages check nothing, and would send another number for one that is too large.
_INTEGERS = {
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    "char": (0, 255),
}


def _integer(name: str, value: Any, path: str) -> int:
    least, most = _INTEGERS[name]
    expected = f"a whole number from {least} to {most} ({name})"
    try:
        if isinstance(value, float) and not value.is_integer():
            raise ValueError
        number = int(value)
    except (TypeError, ValueError):
        raise _wrong(path, value, expected) from None
    if not least <= number <= most:
        raise _wrong(path, value, expected)
    return number


def _octet(value: Any, path: str) -> bytes:
    if isinstance(value, str) and len(value) == 1:
        value = ord(value)
    if isinstance(value, int) and 0 <= value <= 255:
        return bytes([value])
    raise _wrong(path, value, "a whole number from 0 to 255 (byte)")


def _wrong(path: str, value: Any, expected: str) -> CommandError:
    return CommandError(
        f"Failed to populate field: '{path}' got {value!r}" if path else f"Failed to populate field: got {value!r}",
        f"Expected {expected}.",
    )


def _unknown(message: Any, name: Any, path: str) -> UnknownFieldError:
    where = f" in '{path}'" if path else ""
    lines = [
        f"Failed to populate field: '{type(message).__name__}' object has no attribute '{name}'{where}",
        f"Fields of {type_name(message)}: {field_names(message)}.",
    ]
    if not isinstance(name, str):
        lines.append(f"YAML reads this field's name as {name!r}, not as text: quote it.")
    return UnknownFieldError(*lines)


def type_name(message: Any) -> str:
    """Return the type of a message or its class, such as `geometry_msgs/msg/Twist`."""
    kind = message if isinstance(message, type) else type(message)
    package, interface = kind.__module__.split(".")[:2]
    return f"{package}/{interface}/{kind.__name__}"


def field_names(message: Any) -> str:
    """Return the fields of a message or its class with their types, for a line of text."""
    fields = [f"{name} ({kind})" for name, kind in message.get_fields_and_field_types().items()]
    more = f" and {len(fields) - _LISTED} more" if len(fields) > _LISTED else ""
    return ", ".join(fields[:_LISTED]) + more if fields else "none"
