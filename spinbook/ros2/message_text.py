"""Messages as text: the YAML and the CSV that the real command prints."""

from __future__ import annotations

import array
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml
from rosidl_parser import definition


@dataclass(frozen=True)
class Brevity:
    """What is left out: elements and letters after `length` (None: nothing), every array, every string."""

    length: int | None = None
    no_arrays: bool = False
    no_strings: bool = False


WHOLE = Brevity()


class _Dumper(yaml.Dumper):
    """Mappings in the order of the fields, in block style as far as they can be, as the real command has them."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _mapping(dumper: _Dumper, data: dict[str, Any]) -> yaml.MappingNode:
    pairs = [(dumper.represent_data(key), dumper.represent_data(value)) for key, value in data.items()]
    return yaml.MappingNode("tag:yaml.org,2002:map", pairs)


_Dumper.add_representer(dict, _mapping)


def to_yaml(message: Any, brevity: Brevity = WHOLE, *, flow_style: bool = False) -> str:
    """A message as YAML, with a line end. `flow_style` puts arrays on one line."""
    text: str = yaml.dump(
        _fields(message, brevity), Dumper=_Dumper, allow_unicode=True, width=sys.maxsize, default_flow_style=flow_style
    )
    return text


def to_csv(message: Any, brevity: Brevity = WHOLE) -> str:
    """A message's values, nested ones too, divided by commas."""
    types = message.get_fields_and_field_types()
    return _join(
        _csv(getattr(message, name), slot, brevity) for name, slot in zip(types, message.SLOT_TYPES, strict=True)
    )


def _join(parts: Iterable[str]) -> str:
    """Commas between the parts, but as in the real command none before the first that is not empty."""
    text = ""
    for part in parts:
        text += f",{part}" if text else part
    return text


def is_message(value: Any) -> bool:
    """Whether this is a message, and not a number, a text or an array."""
    return hasattr(value, "get_fields_and_field_types")


def _fields(message: Any, brevity: Brevity) -> dict[str, Any]:
    names = message.get_fields_and_field_types()
    return {
        name: _plain(getattr(message, name), slot, brevity)
        for name, slot in zip(names, message.SLOT_TYPES, strict=True)
    }


def _plain(value: Any, slot: Any, brevity: Brevity) -> Any:
    """What YAML has for a field's value."""
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
    return _fields(value, brevity) if is_message(value) else value


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
    """What `--no-arr` prints in an array's place."""
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
