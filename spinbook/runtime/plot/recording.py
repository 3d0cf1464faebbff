"""What a recorder has heard so far, as curves."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field

from spinbook.runtime.plot.quantity import Quantity


@dataclass
class Curve:
    """One quantity over time: `times` and `values` have the same length; times in s, on the messages' own clock."""

    quantity: Quantity
    times: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)


@dataclass
class Recording:
    """Curves in the order in which they first appeared, and what is still waited for."""

    curves: dict[Quantity, Curve] = field(default_factory=dict)
    waiting: list[str] = field(default_factory=list)
    published: list[str] = field(default_factory=list)
    error: str | None = None

    def take(self, lines: Iterable[str]) -> None:
        """Take in lines that the recorder printed; whatever else a library printed among them is passed over."""
        for line in lines:
            try:
                kind, *rest = json.loads(line)
            except (ValueError, TypeError):
                continue
            if kind == "sample":
                topic, axis, unit, label, when, value = rest
                quantity = Quantity(topic, axis, unit, label)
                curve = self.curves.setdefault(quantity, Curve(quantity))
                curve.times.append(when)
                curve.values.append(value)
            elif kind == "waiting":
                self.waiting, self.published = rest
            elif kind == "error":
                self.error = rest[0]

    @property
    def start(self) -> float:
        """The time of the first sample (s)."""
        return min((curve.times[0] for curve in self.curves.values()), default=0.0)
