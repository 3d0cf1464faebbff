"""What all values of a field have in common: a sign, a unit, a factor, an offset, a time step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.comparator import equal
from grader.checking.hint_texts import hints
from groundwork.words import counted

#: The factor in a speed whose time is measured with the computer's clock: see `grader.runner.grader_side`.
COMPUTER_CLOCK = 0.8

#: A value this close to 0 says nothing about a ratio.
SMALLEST = 1e-3

#: A text with more characters is not one of a few that a task gives.
LONGEST_WORDS = 40

#: A finding about all values needs at least this many values.
FEWEST = 3

#: Units that are often confused: the expected unit, the unit that was sent, and the factor between them.
UNITS = (
    ("rad", "degrees", 180 / math.pi),
    ("deg", "radians", math.pi / 180),
    ("m", "millimetres", 1e3),
    ("m", "centimetres", 1e2),
    ("m", "kilometres", 1e-3),
    ("s", "milliseconds", 1e3),
    ("s", "microseconds", 1e6),
    ("s", "nanoseconds", 1e9),
)


_STEP = hints("time_step")


def fixed_step(pairs: list[tuple[float, float]], elapsed: list[float], field: str, unit: str) -> Cause:
    """Explain that every rate was computed with one time step, whatever the real time between messages."""
    if not unit.endswith("/s"):
        return UNKNOWN
    steps = [
        dt * expected / got
        for (expected, got), dt in zip(pairs, elapsed, strict=True)
        if dt > 0 and abs(expected) > SMALLEST and math.isfinite(expected) and math.isfinite(got) and got
    ]
    if len(steps) < FEWEST or not all(math.isclose(step, steps[0], rel_tol=1e-3) for step in steps) or steps[0] <= 0:
        return UNKNOWN
    if math.isclose(steps[0], 1.0, rel_tol=1e-3):
        text = f"Every {field} is the change between two messages, not divided by the time between them."
        return Cause(text, *_STEP)
    if max(elapsed) - min(elapsed) < 1e-3:
        return UNKNOWN  # any factor looks like another time step
    return Cause(f"Every {field} would be right if {steps[0]:.4g} s had passed between the two messages.", *_STEP)


def common(pairs: Sequence[tuple[float, float]], field: str, unit: str = "") -> Cause:
    """Return what all pairs of an expected and a received value have in common.

    `unit` is the unit that the task asks for. A factor of 0.8 or 1.25 is attributed to the computer's clock.
    """
    telling = [(e, g) for e, g in pairs if abs(e) > SMALLEST and math.isfinite(e) and math.isfinite(g)]
    if len(telling) < FEWEST:
        return _degrees(telling, field, unit)
    if len({got for _, got in telling}) == 1:
        right = sum(math.isclose(got, expected, rel_tol=1e-6) for expected, got in telling)
        return _constant(field, telling[0][1]) if 2 * right < len(telling) else UNKNOWN
    if any(e < 0 for e, _ in telling) and all(math.isclose(g, abs(e), rel_tol=1e-6) for e, g in telling):
        return Cause(f"No {field} is negative: the sign is lost.", *hints("wrong_sign"))
    if (digits := _digits(telling)) is not None:
        so = f"rounded to {counted(digits, 'decimal')}" if digits else "a whole number"
        return Cause(f"Every {field} is {so}.", *hints("rounded"))
    ratio = telling[0][1] / telling[0][0]
    if all(math.isclose(g, ratio * e, rel_tol=1e-3, abs_tol=1e-9) for e, g in telling):
        return _ratio(ratio, field, unit)
    offset = telling[0][1] - telling[0][0]
    if all(math.isclose(g - e, offset, rel_tol=1e-3, abs_tol=1e-9) for e, g in telling):
        return _offset(offset, field)
    return UNKNOWN


def _digits(telling: Sequence[tuple[float, float]]) -> int | None:
    """Return to how many decimals every value is rounded; None if they are not."""
    for digits in range(5):
        if all(abs(got - round(expected, digits)) < 1e-9 for expected, got in telling):
            return digits
    return 0 if all(got == math.trunc(expected) for expected, got in telling) else None


def _degrees(telling: Sequence[tuple[float, float]], field: str, unit: str) -> Cause:
    """Return the cause of degrees for radians: no other mistake has this factor, so that one value shows it."""
    exact = all(math.isclose(got, math.degrees(expected), rel_tol=1e-5) for expected, got in telling)
    return _unit(field, "degrees", "rad") if telling and exact and unit == "rad" else UNKNOWN


def _constant(field: str, value: float) -> Cause:
    return Cause(f"Every {field} is {value:.6g}.", *hints("constant", field=field))


def _offset(offset: float, field: str) -> Cause:
    text = f"Every {field} is {abs(offset):.4g} too {'large' if offset > 0 else 'small'}."
    return Cause(text, *hints("offset"))


def _ratio(ratio: float, field: str, unit: str) -> Cause:
    if math.isclose(ratio, 1, rel_tol=1e-3):
        return UNKNOWN
    if math.isclose(ratio, -1, rel_tol=1e-3):
        return _SIGN
    for asked, used, factor in UNITS:
        if math.isclose(ratio, factor, rel_tol=1e-3) and (unit.split("/")[0] == asked or (not unit and asked == "rad")):
            return _unit(field, used, unit or asked)
    text = f"Every {field} is {ratio:.4g} times what it should be"
    if any(math.isclose(ratio, factor, rel_tol=1e-3) for factor in (COMPUTER_CLOCK, 1 / COMPUTER_CLOCK)):
        text += ": your node measures time with the computer's clock, which runs at another speed here."
        return Cause(text, *_STEP)
    return Cause(f"{text}.", *hints("factor", ratio=f"{ratio:.4g}"))


_SIGN = Cause("Every value has the wrong sign.", *hints("wrong_sign"))


def _unit(field: str, used: str, asked: str) -> Cause:
    return Cause(f"Every {field} is in {used}.", *hints("unit", used=used, asked=asked))


def shift(expected: Sequence[Any], got: Sequence[Any], tolerance: float) -> Cause:
    """Say whether each value is the one that was expected before, or the one after; UNKNOWN if neither."""
    if len(expected) < 4 or len(got) < 4 or equal(got[: len(expected)], expected[: len(got)], tolerance):
        return UNKNOWN
    for mine, its, text in ((got[1:], expected, "one message late"), (got, expected[1:], "one message early")):
        count = min(len(mine), len(its))
        if count >= FEWEST and equal(mine[:count], its[:count], tolerance) and len({repr(value) for value in mine}) > 1:
            return Cause(f"Every message is {text}.", *ORDER)
    return UNKNOWN


#: For values that are right and come one message too late or too early.
ORDER = hints("order")


def always(pairs: Sequence[tuple[str, str]], field: str) -> Cause:
    """Explain that a text is the same every time, although several were expected."""
    expected, got = ({pair[side] for pair in pairs} for side in (0, 1))
    if len(pairs) < FEWEST or len(got) > 1 or len(expected) < 2 or not any(got):
        return UNKNOWN
    return Cause(f"{field} is {got.pop()!r} every time.", *hints("constant", field=field))


def other_text(got: Any, expected: Any, task: str) -> Cause:
    """Explain that a short text is not the one that was expected, and none that the task has as code either."""
    if not isinstance(got, str) or not isinstance(expected, str) or not got or len(expected) > LONGEST_WORDS:
        return UNKNOWN
    if f"`{got}`" in task or f"`{expected}`" not in task:
        return UNKNOWN
    if "".join(filter(str.isalnum, got.lower())) == "".join(filter(str.isalnum, expected.lower())):
        return Cause("Only capital letters, spaces or punctuation differ.", *hints("other_text"))
    return Cause("The task has no such text.", *hints("other_text"))
