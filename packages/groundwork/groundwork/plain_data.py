"""Makes dataclasses again from the plain data that `dataclasses.asdict` and JSON made of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from datetime import datetime
from functools import cache, partial
from typing import Any, TypeVar, cast, get_args, get_origin, get_type_hints

Data = TypeVar("Data")


def restored(kind: type[Data], entries: Mapping[str, Any]) -> Data:
    """Return the dataclass with these entries: with dataclasses in it, tuples and dictionaries of them, and times.

    Raises ValueError, KeyError or TypeError for entries that are not its.
    """
    made = {name: make(entries[name]) for name, make in _makers(cast(Any, kind)).items() if name in entries}
    return kind(**{**entries, **made})


@cache
def _makers(kind: Any) -> dict[str, Callable[[Any], Any]]:
    """Return what makes the values of those fields whose types JSON does not have."""
    hints = get_type_hints(kind)
    makers = {field.name: _maker(hints[field.name]) for field in fields(kind)}
    return {name: maker for name, maker in makers.items() if maker}


def _maker(hint: Any) -> Callable[[Any], Any] | None:
    if hint is datetime:
        return datetime.fromisoformat
    if is_dataclass(hint):
        return partial(restored, cast(type, hint))
    origin = get_origin(hint)
    make = next(filter(None, map(_maker, get_args(hint))), None)
    if make is None:
        return tuple if origin is tuple else None
    if origin is tuple:
        return lambda values: tuple(map(make, values))
    if origin is dict:
        return lambda values: {name: make(value) for name, value in {**values}.items()}
    return lambda value: None if value is None else make(value)
