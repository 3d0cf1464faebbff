"""What a plot of a grade shows: what the node published over simulated time, and what the solution published."""

from __future__ import annotations

import math
from dataclasses import dataclass

from grader.checking.comparator import equal
from grader.checking.run import Message, Run
from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade

#: (seconds after the scenario's start, value)
Point = tuple[float, float]

#: The highest value that is drawn, and how many curves are.
HIGHEST, MOST = 1e9, 24


@dataclass(frozen=True)
class Quantity:
    """The field that is drawn. `element` is what one value is called; the list `named_by` has their names."""

    field: str
    unit: str
    element: str
    named_by: str


@dataclass(frozen=True)
class Curve:
    """One element. Values that are not finite are left out of `expected` and `got`, but count as wrong.

    `first_wrong` is the first point that differs from the solution, at the node's value; if it has none, or none that
    can be drawn, at the solution's.
    """

    element: str
    expected: tuple[Point, ...]
    got: tuple[Point, ...]
    first_wrong: Point | None


def drawn_quantity(exercise: Exercise) -> Quantity | None:
    """Return the first field that the node publishes and exercise.toml gives a unit for."""
    for topic in exercise.outputs:
        for field, unit in topic.units.items():
            called, named_by = (topic.elements.called, topic.elements.named_by) if topic.elements else ("value", "name")
            return Quantity(field, unit, called, named_by)
    return None


def curves(grade: Grade, exercise: Exercise, scenario: str, quantity: Quantity) -> tuple[Curve, ...]:
    """Return the curves of one scenario that is in the grade's recordings, one for each name.

    A field that is a single number gives one curve, named as the field. Messages without such a field or without names
    give none.
    """
    run = Run(exercise, grade.recordings[scenario], grade.references[scenario])
    expected: dict[str, list[Point]] = {}
    got: dict[str, list[Point]] = {}
    try:
        for exchange in run.exchanges:
            for lines, messages in ((expected, exchange.expected), (got, exchange.answers)):
                for message in messages:
                    for element, value in _values(message, quantity).items():
                        lines.setdefault(str(element), []).append((exchange.sent.at, _number(value)))
    except (KeyError, TypeError):
        return ()
    elements = [*expected, *(element for element in got if element not in expected)][:MOST]
    return tuple(_curve(element, expected.get(element, []), got.get(element, [])) for element in elements)


def _values(message: Message, quantity: Quantity) -> dict[str, object]:
    value = message.value(quantity.field)
    if isinstance(value, (int, float)):
        return {quantity.field: value}
    return message.by(quantity.named_by, quantity.field)


def _number(value: object) -> float:
    return float(value) if isinstance(value, (int, float)) else math.nan


def _curve(element: str, expected: list[Point], got: list[Point]) -> Curve:
    return Curve(element, _drawable(expected), _drawable(got), _first_difference(dict(expected), dict(got)))


def _drawable(points: list[Point]) -> tuple[Point, ...]:
    return tuple(point for point in points if abs(point[1]) < HIGHEST)


def _first_difference(expected: dict[float, float], got: dict[float, float]) -> Point | None:
    for at in sorted({*expected, *got}):
        if at not in expected or at not in got or not equal(got[at], expected[at], 1e-6):
            shown = (value for value in (got.get(at), expected.get(at)) if value is not None and abs(value) < HIGHEST)
            return at, next(shown, 0.0)
    return None
