"""Messages as YAML, CSV and dictionaries."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

from ros_in_python.ros2.messages import Brevity, to_csv, to_dict, to_yaml


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Return a message as YAML; `truncate_length` shortens arrays and texts, `no_arr` and `no_str` leave them out."""
    return to_yaml(msg, Brevity(truncate_length, no_arr, no_str), flow_style=flow_style)


def message_to_csv(msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False) -> str:
    """Return a message's values, separated by commas."""
    return to_csv(msg, Brevity(truncate_length, no_arr, no_str))


def message_to_ordereddict(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> OrderedDict[str, Any]:
    """Return a message's fields, with nested messages as dictionaries and arrays as lists."""
    ordered: OrderedDict[str, Any] = _ordered(to_dict(msg, Brevity(truncate_length, no_arr, no_str)))
    return ordered


def _ordered(value: Any) -> Any:
    if isinstance(value, dict):
        return OrderedDict((name, _ordered(item)) for name, item in value.items())
    return [_ordered(item) for item in value] if isinstance(value, list) else value


def get_message_slot_types(msg: Any) -> OrderedDict[str, Any]:
    """Return the type of each field, as rosidl_parser describes it."""
    return OrderedDict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))
