"""Checks the values of a scenario against the definitions of messages, services and actions."""

from __future__ import annotations

import contextlib
import re
from typing import Any

from grader.recording.arrays import CODES, LONG, LongArray, plain_array
from grader.recording.events import Fields
from grader.recording.types import message_class

_INTEGERS = {f"{sign}int{bits}": (bits, sign == "") for bits in (8, 16, 32, 64) for sign in ("", "u")}
#: Types of elements that fit whatever their value is; most lists have thousands of these.
_ALWAYS_FITS = {"double": float, "float": float, "boolean": bool, "string": str}
_LIST = re.compile(r"sequence<(?P<of>.+?)(, (?P<most>\d+))?>|(?P<array>.+)\[(?P<size>\d+)\]")
_TEXT = re.compile(r"w?string(<(?P<most>\d+)>)?")


class InvalidValue(ValueError):
    """Raised for a value that does not fit; `field` is its full name, such as linear.x."""

    def __init__(self, field: str, problem: str, fix: str) -> None:
        super().__init__(f"{field}: {problem}")
        self.field, self.problem, self.fix = field, problem, fix


def checked_fields(kind: Any, fields: Fields, name: str, at: str = "") -> Fields:
    """Return the fields of a message, request or goal of the class `kind`, called `name` in errors, as plain data.

    Lists of numbers may also be given as arrays of Python or numpy; `uint8[]` and `byte[]` also as bytes, a bytearray
    or a memoryview.

    Raises `InvalidValue` for what such a message can't have.
    """
    if not isinstance(fields, dict):
        raise InvalidValue(at or name, f"{_shown(fields)} is given for a {name}", "Give a dictionary of its fields.")
    known, checked = kind.get_fields_and_field_types(), {}
    for field, value in fields.items():
        where = f"{at}.{field}" if at else field
        if field not in known:
            fix = f"Its fields: {', '.join(known)}." if known else "It has no fields."
            raise InvalidValue(where, f"{name} has no field {field!r}", fix)
        checked[field] = _checked(known[field], value, where, name)
    return checked


def _checked(type_name: str, value: Any, field: str, name: str) -> Any:
    if found := _LIST.fullmatch(type_name):
        return _checked_list(found, type_name, value, field, name)
    if "/" in type_name:
        package, _, short = type_name.partition("/")
        return checked_fields(message_class(f"{package}/msg/{short}"), value, f"{package}/msg/{short}", field)
    if hasattr(value, "item") and getattr(value, "shape", None) == ():  # a number of numpy's
        value = value.item()
    if type_name == "octet":
        type_name, value = "uint8", value[0] if isinstance(value, bytes) and len(value) == 1 else value
    _check_value(type_name, value, field, name)
    return value


def _check_value(type_name: str, value: Any, field: str, name: str) -> None:
    if type_name in ("double", "float"):
        _expect(isinstance(value, float), type_name, value, field, name, "Write it with a point, such as 1.0.")
    elif type_name == "boolean":
        _expect(isinstance(value, bool), type_name, value, field, name, "Write True or False.")
    elif type_name in _INTEGERS:
        _check_integer(type_name, value, field, name)
    elif found := _TEXT.fullmatch(type_name):
        fits = isinstance(value, str) and (not found["most"] or len(value) <= int(found["most"]))
        _expect(fits, type_name, value, field, name, "Write a text in quotes.")


def _checked_list(found: re.Match[str], type_name: str, value: Any, field: str, name: str) -> Any:
    kind = found["of"] or found["array"]
    value = _as_list(kind, value)
    if getattr(value, "ndim", 1) > 1 and not isinstance(value, memoryview):
        problem = f"an array of the shape {value.shape} is given for {field}, which is {type_name} in {name}"
        raise InvalidValue(field, problem, "Write array.ravel(), row by row.")
    _expect(isinstance(value, (list, tuple, LongArray)), type_name, value, field, name, "Write a list.")
    if found["size"]:
        fix = f"Give {found['size']} values."
        _expect(len(value) == int(found["size"]), type_name, value, field, name, fix)
    if found["most"]:
        fix = f"Give at most {found['most']} values."
        _expect(len(value) <= int(found["most"]), type_name, value, field, name, fix)
    if isinstance(value, LongArray) and value.typecode == CODES.get(kind):
        return value
    if set(map(type, value)) == {_ALWAYS_FITS.get(kind)}:
        return list(value)
    return [_checked(kind, one, f"{field}[{index}]", name) for index, one in enumerate(value)]


def _as_list(kind: str, value: Any) -> Any:
    """Return arrays as lists, and long ones of the right type as `LongArray`; anything else as it is."""
    code = CODES.get(kind, "")
    if code == "B" and isinstance(value, (bytes, bytearray, memoryview)):
        return plain_array("B", bytes(value))
    if hasattr(value, "tolist") and getattr(value, "ndim", 1) == 1 and not isinstance(value, (LongArray, memoryview)):
        value = value.tolist()
    of_python = {int} if kind in _INTEGERS or kind == "octet" else {float}
    if code and isinstance(value, (list, tuple)) and len(value) >= LONG and set(map(type, value)) == of_python:
        with contextlib.suppress(OverflowError):  # the first number that does not fit is found below
            return plain_array(code, value)
    return value


def _check_integer(type_name: str, value: Any, field: str, name: str) -> None:
    whole = isinstance(value, int) and not isinstance(value, bool)
    _expect(whole, type_name, value, field, name, "Write a whole number.")
    bits, signed = _INTEGERS[type_name]
    lowest, highest = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)
    fix = f"Give a number from {lowest} to {highest}."
    _expect(lowest <= value <= highest, type_name, value, field, name, fix)


def _expect(fits: bool, type_name: str, value: Any, field: str, name: str, fix: str) -> None:
    if not fits:
        raise InvalidValue(field, f"{_shown(value)} is given for {field}, which is {type_name} in {name}", fix)


def _shown(value: Any) -> str:
    text = f"{value!r} ({type(value).__name__})"
    return text if len(text) < 80 else f"{text[:80]}…"
