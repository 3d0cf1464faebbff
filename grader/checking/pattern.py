"""Wrong numbers often are the right ones, changed in one way throughout. Says so where it is seen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from grader.checking.lateness import is_one_late

if TYPE_CHECKING:
    from grader.checking.run import Exchange, Message, Run

#: What a speed is multiplied with when its time is measured with the computer's clock: see `grader.runner.clocks`.
COMPUTER_CLOCK = 0.8

#: A value this near to 0 tells nothing about a ratio.
SMALLEST = 1e-3

#: So many values have to have something in common before anything is said about all of them.
FEWEST = 3

#: Units that are mistaken for each other: the unit that is asked for, the one that was given, and the factor between.
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


def pattern(run: Run, field: str, per: str = "", unit: str = "") -> str:
    """A sentence about what all values of `field` have in common, beginning with a space; empty where nothing.

    `per` names the list of names that `field` goes with; without it, `field` is one number.
    """
    if is_one_late(run):
        return " Every answer is one message late: it is the right one to the message before."
    if copied := _copied(run, field, per):
        return f" Every {field} is the {copied} of the message that arrived, unchanged."
    pairs: list[tuple[float, float]] = []
    elapsed: list[float] = []
    for before, exchange in zip([None, *run.exchanges], run.exchanges, strict=False):
        if exchange.expected and exchange.answers:
            expected, got = _values(exchange.expected[0], field, per), _values(exchange.answers[0], field, per)
            pairs += [(expected[name], got[name]) for name in expected if name in got]
            elapsed += [_elapsed(before, exchange) for name in expected if name in got]
    if told := _fixed_step(pairs, elapsed, field, unit):
        return told
    return common(pairs, field, unit, clock=run.recording.hold == "lockstep")


def _elapsed(before: Exchange | None, exchange: Exchange) -> float:
    """Seconds between the stamps of two messages; of messages without a stamp, between their arrivals."""
    if before is None:
        return 0.0
    if "header" in exchange.sent._fields:
        return exchange.sent.stamp - before.sent.stamp
    return exchange.sent.at - before.sent.at


def _fixed_step(pairs: list[tuple[float, float]], elapsed: list[float], field: str, unit: str) -> str:
    """Whether every rate was computed with one time step, whatever time had gone by."""
    if not unit.endswith("/s"):
        return ""
    steps = [
        dt * expected / got
        for (expected, got), dt in zip(pairs, elapsed, strict=True)
        if dt > 0 and abs(expected) > SMALLEST and math.isfinite(expected) and math.isfinite(got) and got
    ]
    if len(steps) < FEWEST or not all(math.isclose(step, steps[0], rel_tol=1e-3) for step in steps) or steps[0] <= 0:
        return ""
    if math.isclose(steps[0], 1.0, rel_tol=1e-3):
        return f" Every {field} is the change between two messages, not divided by the time between them."
    if max(elapsed) - min(elapsed) < 1e-3:
        return ""  # any factor looks like another time step
    return f" Every {field} would be right if {steps[0]:.4g} s had passed between the two messages."


def common(pairs: Sequence[tuple[float, float]], field: str, unit: str = "", clock: bool = False) -> str:
    """What all pairs of an expected value and a value that was got have in common, as `pattern` says it.

    `unit` is the unit that is asked for. With `clock`, a factor of 0.8 or 1.25 is put down to the computer's clock.
    """
    telling = [(e, g) for e, g in pairs if abs(e) > SMALLEST and math.isfinite(e) and math.isfinite(g)]
    if len(telling) < FEWEST:
        return ""
    if len({got for _, got in telling}) == 1:
        return f" Every {field} is {telling[0][1]:.6g}."
    ratio = telling[0][1] / telling[0][0]
    if all(math.isclose(g, ratio * e, rel_tol=1e-3, abs_tol=1e-9) for e, g in telling):
        return _ratio(ratio, field, unit, clock)
    offset = telling[0][1] - telling[0][0]
    if all(math.isclose(g - e, offset, rel_tol=1e-3, abs_tol=1e-9) for e, g in telling):
        return f" Every {field} is {abs(offset):.4g} too {'large' if offset > 0 else 'small'}."
    return ""


def _ratio(ratio: float, field: str, unit: str, clock: bool) -> str:
    if math.isclose(ratio, 1, rel_tol=1e-3):
        return ""
    if math.isclose(ratio, -1, rel_tol=1e-3):
        return " Every value has the wrong sign."
    for asked, given, factor in UNITS:
        if math.isclose(ratio, factor, rel_tol=1e-3) and (unit.split("/")[0] == asked or (not unit and asked == "rad")):
            return f" Every {field} is in {given}."
    told = f" Every {field} is {ratio:.4g} times what it should be"
    if clock and any(math.isclose(ratio, factor, rel_tol=1e-3) for factor in (COMPUTER_CLOCK, 1 / COMPUTER_CLOCK)):
        return f"{told}: your node measures time with the computer's clock, which goes at another speed here."
    return f"{told}."


def _copied(run: Run, field: str, per: str) -> str:
    """The field of the messages that arrived which every answer repeats; empty if none."""
    answered = [exchange for exchange in run.exchanges if exchange.expected and exchange.answers]
    fields = answered[0].sent._fields if answered else {}
    return next((name for name in fields if name != per and _is_copied(answered, field, per, name)), "")


def _is_copied(answered: list[Exchange], field: str, per: str, name: str) -> bool:
    pairs = []
    for exchange in answered:
        if per and per not in exchange.sent._fields:
            return False
        sent, got = _values(exchange.sent, name, per), _values(exchange.answers[0], field, per)
        pairs += [(sent[key], got[key]) for key in got if key in sent]
    several = len({got for _, got in pairs}) > 1
    return several and all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12) for a, b in pairs)


def _values(message: Message, field: str, per: str) -> dict[str, float]:
    """The numbers in a field, by name."""
    value = message.value(field)
    if isinstance(value, list):
        names = message.value(per) if per else [str(i) for i in range(len(value))]
        values = dict(zip(names, value, strict=False))
    else:
        values = {"": value}
    return {name: one for name, one in values.items() if isinstance(one, (int, float))}
