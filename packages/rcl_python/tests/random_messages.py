"""Messages of every installed type, with values that hypothesis chooses."""

from __future__ import annotations

import array
import importlib
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy
from hypothesis import strategies as st

_INDEX = Path(sys.prefix, "share", "ament_index", "resource_index", "rosidl_interfaces")
_INTEGERS = {f"{sign}int{bits}": (sign, bits) for sign in ("", "u") for bits in (8, 16, 32, 64)}
_CODES = {
    "float": "f", "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H",
    "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q",
}  # fmt: skip
_NUMPY = {"float": "float32", "double": "float64"}


def message_classes() -> Iterator[Any]:
    """Yield every message class of every installed interface package; of services and actions, each part."""
    for listing in sorted(_INDEX.iterdir()):
        for line in listing.read_text().split():
            kind, _, file = line.partition("/")
            if not file.endswith(".idl"):
                name = file.rpartition(".")[0]
                yield from _parts(kind, getattr(importlib.import_module(f"{listing.name}.{kind}"), name))


def _parts(kind: str, whole: Any) -> list[Any]:
    if kind == "msg":
        return [whole]
    if kind == "srv":
        return [whole.Request, whole.Response, whole.Event]
    services = (whole.Impl.SendGoalService, whole.Impl.GetResultService)
    parts = [part for service in services for part in (service.Request, service.Response, service.Event)]
    return [whole.Goal, whole.Result, whole.Feedback, whole.Impl.FeedbackMessage, *parts]


#: How many items a sequence has at most: one of the message itself, and one of a message inside it. Nests of sequences
#: would otherwise grow beyond what hypothesis draws for one example, and most examples would be thrown away.
_ITEMS, _ITEMS_INSIDE = 3, 1


@cache
def messages(kind: Any, items: int = _ITEMS) -> st.SearchStrategy[Any]:
    """Return a strategy for messages of one class, with at most so many items in each sequence."""
    names = [name for name in kind.__slots__ if name != "_check_fields"]
    fields = [_values(slot, items) for slot in kind.SLOT_TYPES]

    def filled(values: tuple[Any, ...]) -> Any:
        message = kind()
        for name, value in zip(names, values, strict=True):
            setattr(message, name, value)
        return message

    return st.tuples(*fields).map(filled)


def _values(slot: Any, items: int) -> st.SearchStrategy[Any]:
    kind = type(slot).__name__
    if kind == "BasicType":
        return _numbers(slot.typename)
    if kind.endswith("String"):
        most = getattr(slot, "maximum_size", 12)
        return st.text(st.characters(codec="utf-8"), max_size=min(most, 12) // 2)
    if kind == "NamespacedType":
        whole = getattr(importlib.import_module(".".join(slot.namespaces)), slot.name.split("_")[0])
        return messages(getattr(sys.modules[whole.__module__], slot.name), _ITEMS_INSIDE)
    return _sequences(slot, kind, items)


def _numbers(name: str) -> st.SearchStrategy[Any]:
    if name in _INTEGERS:
        sign, bits = _INTEGERS[name]
        low = 0 if sign else -(2 ** (bits - 1))
        return st.integers(low, low + 2**bits - 1)
    if name in ("float", "double"):
        return st.floats(width=32 if name == "float" else 64)
    return {"boolean": st.booleans(), "octet": st.binary(min_size=1, max_size=1), "char": st.integers(0, 255)}[name]


def _sequences(slot: Any, kind: str, most: int) -> st.SearchStrategy[Any]:
    name = getattr(slot.value_type, "typename", "")
    if kind == "Array":
        items = st.lists(_values(slot.value_type, most), min_size=slot.size, max_size=slot.size)
        kept = getattr(numpy, _NUMPY.get(name, name)) if name in _CODES else None
        return items.map(lambda values: numpy.array(values, dtype=kept)) if kept else items
    items = st.lists(_values(slot.value_type, most), max_size=min(getattr(slot, "maximum_size", most), most))
    return items.map(lambda values: array.array(_CODES[name], values)) if name in _CODES else items
