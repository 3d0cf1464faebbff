"""Round values for the marks of an axis."""

from __future__ import annotations

import math


def round_values(low: float, high: float) -> list[float]:
    """Return up to five round values from `low` to `high`, which is greater: 1, 2 or 5 times a power of ten apart."""
    span = high - low
    step = 10.0 ** math.floor(math.log10(span / 5))
    step *= next((factor for factor in (1, 2, 5) if span / (step * factor) <= 5), 10)
    # A mark is written with the digits of its step: 3 * 0.1 is 0.3.
    digits = max(0, -math.floor(math.log10(step)))
    numbers = range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)
    return [round(step * number, digits) for number in numbers]
