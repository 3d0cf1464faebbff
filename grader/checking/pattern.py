"""Wrong numbers often are the right ones, changed in one way throughout. Says so where it is seen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grader.checking.run import Run

#: A value this near to 0 tells nothing about a ratio.
SMALLEST = 1e-3


def pattern(run: Run, field: str, per: str) -> str:
    """A sentence about what all values of `field` have in common, beginning with a space; empty where nothing."""
    pairs: list[tuple[float, float]] = []
    positions: list[tuple[float, float]] = []
    for exchange in run.exchanges:
        if exchange.expected and exchange.answers:
            expected, got = exchange.expected[0].by(per, field), exchange.answers[0].by(per, field)
            pairs += [(expected[name], got[name]) for name in expected if name in got]
            if "position" in exchange.sent._fields:
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
    return f" Every {field} is {ratio:.4g} times what it should be."
