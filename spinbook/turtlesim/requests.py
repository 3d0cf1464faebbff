"""Requests written as text, for the services whose types are not there: the fields of the real ones, in YAML."""

from __future__ import annotations

import math
from dataclasses import MISSING, dataclass, fields
from typing import Any, TypeVar

import yaml


@dataclass(frozen=True)
class SpawnRequest:
    """The fields of turtlesim/srv/Spawn: units, rad, and a name or none."""

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0
    name: str = ""


@dataclass(frozen=True)
class SetPenRequest:
    """The fields of turtlesim/srv/SetPen, each 0..255."""

    r: int = 0
    g: int = 0
    b: int = 0
    width: int = 0
    off: int = 0


Request = TypeVar("Request", SpawnRequest, SetPenRequest)


def read_request(kind: type[Request], text: str) -> Request:
    """The request that `text` holds, such as `{x: 2, y: 3, name: bob}`; a field left out is 0 or empty.

    Raises:
        ValueError: if it holds anything else; the message says what was expected.
    """
    defaults = {each.name: each.default for each in fields(kind) if each.default is not MISSING}
    try:
        given = yaml.safe_load(text)
    except (yaml.YAMLError, RecursionError) as error:
        raise ValueError(_expected(defaults, f"{text[:80]!r}, which is no YAML")) from error
    if given is None:
        given = {}
    if not isinstance(given, dict):
        raise ValueError(_expected(defaults, repr(text[:80])))
    values: dict[str, Any] = {}
    for name, value in given.items():
        if name not in defaults:
            raise ValueError(_expected(defaults, f"a field {name!r}"))
        values[name] = _of_the_kind(str(name), value, defaults[name])
    return kind(**values)


def _of_the_kind(name: str, value: object, default: object) -> float | int | str:
    """`value` where it fits a field with that default."""
    if isinstance(default, str):
        return str(value) if value is not None else ""
    if isinstance(default, float):
        return _number(name, value)
    if isinstance(value, int) and 0 <= value <= 255:
        return int(value)
    raise ValueError(f"{name} must be a whole number from 0 to 255, not {value!r}")


def _number(name: str, value: object) -> float:
    # YAML takes 1e-1, without a point, for text.
    if isinstance(value, int | float | str) and not isinstance(value, bool):
        try:
            return float(value)
        except OverflowError:
            return math.inf
        except ValueError:
            pass
    raise ValueError(f"{name} must be a number, not {value!r}")


def _expected(defaults: dict[str, Any], found: str) -> str:
    return f"expected fields of {{{', '.join(defaults)}}}, such as '{{{next(iter(defaults))}: 2}}', found {found}"
