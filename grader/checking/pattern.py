"""Wrong numbers often are the right ones, changed in one way throughout. Says so where it is seen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from grader.checking.lateness import is_one_late

if TYPE_CHECKING:
    from grader.checking.run import Message, Run

#: What a speed is multiplied with when its time is measured with the computer's clock: see `grader.runner.clocks`.
COMPUTER_CLOCK = 0.8

#: A value this near to 0 tells nothing about a ratio.
SMALLEST = 1e-3


def pattern(run: Run, field: str, per: str = "") -> str:
    """A sentence about what all values of `field` have in common, beginning with a space; empty where nothing.

    `per` names the list of names that `field` goes with; without it, `field` is one number.
    """
    if is_one_late(run):
        return " Every answer is one message late: it is the right one to the message before."
    pairs: list[tuple[float, float]] = []
    positions: list[tuple[float, float]] = []
    for exchange in run.exchanges:
        if exchange.expected and exchange.answers:
            expected, got = _values(exchange.expected[0], field, per), _values(exchange.answers[0], field, per)
            pairs += [(expected[name], got[name]) for name in expected if name in got]
            if per and "position" in exchange.sent._fields:
                sent = exchange.sent.by(per, "position")
                positions += [(sent[name], got[name]) for name in got if name in sent]
    if positions and all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12) for a, b in positions):
        return f" Every {field} is the joint's position."
    telling = [(e, g) for e, g in pairs if abs(e) > SMALLEST and math.isfinite(e) and math.isfinite(g)]
    if len(telling) < 3:
        return ""
    if all(g == 0 for _, g in telling):
        return f" Every {field} is 0."
    ratio = telling[0][1] / telling[0][0]
    if not all(math.isclose(g, ratio * e, rel_tol=1e-3, abs_tol=1e-9) for e, g in telling):
        return ""
    if math.isclose(ratio, -1, rel_tol=1e-3):
        return " All signs are turned round."
    if math.isclose(ratio, 180 / math.pi, rel_tol=1e-3):
        return " All values are in degrees."
    told = f" Every {field} is {ratio:.4g} times what it should be"
    if run.recording.hold == "lockstep" and any(
        math.isclose(ratio, factor, rel_tol=1e-3) for factor in (COMPUTER_CLOCK, 1 / COMPUTER_CLOCK)
    ):
        return f"{told}: your node measures time with the computer's clock, which goes at another speed here."
    return f"{told}."


def _values(message: Message, field: str, per: str) -> dict[str, float]:
    """The numbers in a field, by name."""
    values = message.by(per, field) if per else {"": message.value(field)}
    return {name: value for name, value in values.items() if isinstance(value, (int, float))}
