"""Compares two values of a message's fields: numbers, texts, lists and nested messages, as plain data.

The rules, each with a test module of its own in tests/grader/checking/comparator:

- **Floats** are equal within a tolerance in the field's unit, or within one part in a million of the larger of the two
  (with a smaller tolerance, within that part), whichever allows more. A difference of exactly the tolerance is allowed.
- **Integers and booleans** are equal only if they are the same; a boolean never equals a number.
- **NaN** equals NaN and nothing else. An **infinity** equals the infinity of the same sign and nothing else.
- **-0.0** equals 0.0.
- **Lists** are equal if they have the same length and equal elements in the same order. An empty list equals an
  empty list.
- **Nested messages** are equal if they have the same fields and each field is equal.
- **Texts** and everything else are equal if they are the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from grader.recording.arrays import LongArray

#: How far two floats may be apart, absolute or relative, unless a check asks for something else.
TOLERANCE = 1e-6


@dataclass(frozen=True)
class Difference:
    """The first place in which two values differ.

    `path` leads to it from the value that was compared, such as `[2].position.x`. It is empty if the values themselves
    differ. `got` and `expected` are the two values there; for lists of unequal length they are the lists.
    """

    path: str
    got: Any
    expected: Any


def equal(got: Any, expected: Any, tolerance: float = TOLERANCE) -> bool:
    """Return whether two values are the same by the rules above."""
    return difference(got, expected, tolerance) is None


def difference(got: Any, expected: Any, tolerance: float = TOLERANCE, path: str = "") -> Difference | None:
    """Return the first place, in the order of fields and elements, in which two values differ; None if they are equal.

    Raises ValueError if `tolerance` is negative or not a number.
    """
    if not tolerance >= 0:
        raise ValueError(f"tolerance={tolerance!r}: a tolerance is a number of 0 or more.")
    if isinstance(got, LongArray) or isinstance(expected, LongArray):
        return _of_arrays(got, expected, tolerance, path)
    if isinstance(expected, dict) and isinstance(got, dict) and got.keys() == expected.keys():
        steps = ((f"{path}.{name}" if path else str(name), got[name], expected[name]) for name in expected)
    elif isinstance(expected, (list, tuple)) and isinstance(got, (list, tuple)) and len(got) == len(expected):
        steps = ((f"{path}[{i}]", *pair) for i, pair in enumerate(zip(got, expected, strict=True)))
    else:
        return None if _same(got, expected, tolerance) else Difference(path, got, expected)
    differences = (difference(mine, its, tolerance, step) for step, mine, its in steps)
    return next(filter(None, differences), None)


def _of_arrays(got: Any, expected: Any, tolerance: float, path: str) -> Difference | None:
    """Compare arrays of the same type at once; only if they differ, or one is a list, number by number."""
    both = isinstance(got, LongArray) and isinstance(expected, LongArray)
    if both and got.typecode == expected.typecode and got == expected:
        return None
    mine, its = (one.tolist() if isinstance(one, LongArray) else one for one in (got, expected))
    return difference(mine, its, tolerance, path)


def _same(got: Any, expected: Any, tolerance: float) -> bool:
    if isinstance(got, bool) or isinstance(expected, bool):
        return got is expected
    if _is_number(got) and _is_number(expected) and (isinstance(got, float) or isinstance(expected, float)):
        if math.isnan(got) or math.isnan(expected):
            return math.isnan(got) and math.isnan(expected)
        return math.isclose(got, expected, rel_tol=min(tolerance, TOLERANCE), abs_tol=tolerance)
    return type(got) is type(expected) and bool(got == expected)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float))


#: The longest list that is shown whole, and the most characters of anything else.
MOST_ELEMENTS, MOST_CHARACTERS = 8, 200


def shown_apart(expected: Any, got: Any, unit: str) -> tuple[str, str]:
    """Return two values for people, with more digits if these are needed to tell them apart."""
    texts = shown(expected, unit), shown(got, unit)
    if texts[0] == texts[1] and isinstance(expected, float) and isinstance(got, float):
        return shown(expected, unit, digits=12), shown(got, unit, digits=12)
    return texts


def shown(value: Any, unit: str = "", digits: int = 6) -> str:
    """Return a value for people: `0.25 rad/s`, `[1, 2, 3 …]`, a stamp as `100.250000000`."""
    if isinstance(value, float):
        return f"{value:.{digits}g}{f' {unit}' if unit else ''}"
    if isinstance(value, dict) and set(value) == {"sec", "nanosec"}:
        return f"{value['sec']}.{value['nanosec']:09d}"
    if isinstance(value, dict):
        return ", ".join(f"{name} {shown(part)}" for name, part in value.items())[:MOST_CHARACTERS]
    if isinstance(value, (list, tuple, LongArray)):
        text = ", ".join(shown(item) for item in value[:MOST_ELEMENTS])
        return f"[{text}{' …' if len(value) > MOST_ELEMENTS else ''}]"
    text = repr(value) if isinstance(value, str) else str(value)
    text += f" {unit}" if unit and isinstance(value, int) and not isinstance(value, bool) else ""
    return text if len(text) < MOST_CHARACTERS else f"{text[:MOST_CHARACTERS]}…"
