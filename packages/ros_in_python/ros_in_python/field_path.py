"""Paths into a message, such as `position[0]`, `header.stamp` and `twist/linear/x`.

A message is a ROS message, or its fields as a dictionary.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

#: A field's name, or the index of an element.
Step = str | int

_STEP = re.compile(r"([A-Za-z]\w*)((?:\[\d+\])*)")


class NoSuchField(LookupError):
    """A path leads to a field that the message does not have; says which fields it has."""


@functools.lru_cache(maxsize=1024)
def steps_of(path: str) -> tuple[Step, ...]:
    """The steps of a path; none of an empty one. Names are separated by dots or slashes.

    Raises ValueError, with the part that is not a field.

    >>> steps_of("points[2].x")
    ('points', 2, 'x')
    """
    steps: list[Step] = []
    for part in re.split(r"[/.]", path) if path else []:
        match = _STEP.fullmatch(part)
        if match is None:
            raise ValueError(f"`{part}` in `{path}` is not a field. Write for example position[0] or header.stamp.")
        steps += [match[1], *map(int, re.findall(r"\d+", match[2]))]
    return tuple(steps)


def written(steps: Iterable[Step], separator: str = ".") -> str:
    """The steps as a path: `linear.x`, `points[2].x`."""
    return "".join(f"[{step}]" if isinstance(step, int) else f"{separator}{step}" for step in steps)[len(separator) :]


def fields_in(message: Any) -> tuple[str, ...]:
    """The names of a message's fields; none of anything else."""
    if isinstance(message, Mapping):
        return tuple(message)
    fields = getattr(message, "get_fields_and_field_types", dict)
    return tuple(fields())


def value_at(message: Any, steps: Sequence[Step]) -> Any:
    """The value to which the steps lead: the message itself without any.

    Raises NoSuchField for a field that is not there or an index into what is not a list, and IndexError for an element
    that the list does not have.
    """
    value = message
    for step in steps:
        names = fields_in(value)
        if step in names:
            value = value[step] if isinstance(value, Mapping) else getattr(value, str(step))
        elif isinstance(step, int) and not names and hasattr(value, "__getitem__") and not isinstance(value, str):
            value = value[step]
        else:
            raise NoSuchField(f"there is no field `{written(steps)}`. The fields are: {', '.join(names) or 'none'}.")
    return value


def field_of(message: Any, path: str) -> Any:
    """The value to which a path leads; raises what `steps_of` and `value_at` raise."""
    return value_at(message, steps_of(path))
