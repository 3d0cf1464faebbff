"""A scenario as curves: for each joint what the student's node published over what the solution did."""

from __future__ import annotations

import math
from dataclasses import dataclass

from grader.checking import Run
from grader.checking.comparator import equal
from grader.checking.run import Message
from grader.exercise import Exercise
from grader.grading import Grade

#: (seconds after the scenario's start, value)
Point = tuple[float, float]

#: The highest value that is drawn, and how many joints are.
HIGHEST, MOST = 1e9, 24


@dataclass(frozen=True)
class Curve:
    """One joint. Values that are not finite are left out of `expected` and `got`, but count as wrong where they came.

    `first_wrong` is the first point that differs from the solution, at the value that came; where none came or none
    that can be drawn, at the solution's.
    """

    joint: str
    expected: tuple[Point, ...]
    got: tuple[Point, ...]
    first_wrong: Point | None


def curves(grade: Grade, exercise: Exercise, scenario: str, field: str, per: str = "name") -> tuple[Curve, ...]:
    """The curves of `field` in one scenario that is in the grade's recordings: a curve for each name in `per`.

    Where the field is a single number, there is one curve, called as the field.
    """
    run = Run(exercise, grade.recordings[scenario], grade.references[scenario])
    expected: dict[str, list[Point]] = {}
    got: dict[str, list[Point]] = {}
    for exchange in run.exchanges:
        for lines, messages in ((expected, exchange.expected), (got, exchange.answers)):
            for message in messages:
                for joint, value in _values(message, per, field).items():
                    lines.setdefault(str(joint), []).append((exchange.sent.at, _number(value)))
    joints = [*expected, *(joint for joint in got if joint not in expected)][:MOST]
    return tuple(_curve(joint, expected.get(joint, []), got.get(joint, [])) for joint in joints)


def _curve(joint: str, expected: list[Point], got: list[Point]) -> Curve:
    return Curve(joint, _drawable(expected), _drawable(got), _first_difference(dict(expected), dict(got)))


def _first_difference(right: dict[float, float], came: dict[float, float]) -> Point | None:
    for at in sorted({*right, *came}):
        if at not in right or at not in came or not equal(came[at], right[at], 1e-6):
            shown = next((v for v in (came.get(at), right.get(at)) if v is not None and abs(v) < HIGHEST), 0.0)
            return at, shown
    return None


def _values(message: Message, per: str, field: str) -> dict[str, object]:
    value = message.value(field)
    return {field: value} if isinstance(value, (int, float)) else message.by(per, field)


def _number(value: object) -> float:
    return float(value) if isinstance(value, (int, float)) else math.nan


def _drawable(points: list[Point]) -> tuple[Point, ...]:
    return tuple(point for point in points if abs(point[1]) < HIGHEST)
