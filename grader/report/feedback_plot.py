"""The plot on a feedback page: one panel per element, the student's curve over the solution's, as a small SVG."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from grader.checking.comparator import equal
from grader.checking.message import Message
from grader.checking.run import Run
from grader.exercise.exercise import Exercise
from grader.report.pages import template
from grader.report.path_plot import path_of, path_plot
from grader.scenario.times import SECOND, START
from ros_in_python.axis_marks import round_values

if TYPE_CHECKING:
    from grader.grading.grade import Grade

#: (seconds after the scenario's start, value)
Point = tuple[float, float]

#: The highest value that is drawn, and the largest number of curves.
HIGHEST, MOST = 1e9, 24


@dataclass(frozen=True)
class Quantity:
    """The field that is drawn. `element` is the word for one value; the list `named_by` contains the names of all.

    `topic` is the node's. `state` is the topic on which a world publishes it instead, if the node moves it.
    """

    field: str
    unit: str
    element: str
    named_by: str
    topic: str
    state: str = ""


@dataclass(frozen=True)
class Curve:
    """One element. Values that are not finite are left out of `expected` and `got`, but count as wrong.

    `first_wrong` is the first point that differs from the solution, at the node's value. If the node has no value
    there, or none that can be drawn, it is at the solution's.
    """

    element: str
    expected: tuple[Point, ...]
    got: tuple[Point, ...]
    first_wrong: Point | None


def drawn_quantity(exercise: Exercise, grade: Grade, scenario: str) -> Quantity | None:
    """Return the first field that exercise.toml gives a unit for, and that the node publishes; without units, the first
    number that changes.

    In a closed loop, it is the first that the node moves: each node may do that with values of its own.
    """
    for topic in exercise.inputs if scenario in grade.recordings else ():
        mine, its = (
            [message.fields for message in runs[scenario].sent if message.topic == topic.name]
            for runs in (grade.recordings, grade.references)
        )
        if mine != its:
            for field, unit in topic.units.items():
                return Quantity(field, unit, "value", "name", "", topic.name)
    for topic in exercise.outputs:
        for field, unit in topic.units.items():
            called, named_by = (topic.elements.called, topic.elements.named_by) if topic.elements else ("value", "name")
            return Quantity(field, unit, called, named_by, topic.name)
    runs = [of[scenario] for of in (grade.references, grade.recordings) if scenario in of]
    published = [message for run in runs for message in run.received]
    for topic in exercise.outputs:
        values = [dict(_numbers(message.fields)) for message in published if message.topic == topic.name]
        if changing := [field for field in values[0] if len({v.get(field) for v in values}) > 1] if values else []:
            return Quantity(changing[0], "", "value", "name", topic.name)
    return None


def _numbers(fields: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    """Yield each field that is a number, by its full name. A header's stamp only says when."""
    for name, value in fields.items():
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            yield f"{before}{name}", value
        elif isinstance(value, Mapping) and name not in ("header", "stamp"):
            yield from _numbers(value, f"{before}{name}.")


def curves(grade: Grade, exercise: Exercise, scenario: str, quantity: Quantity) -> tuple[Curve, ...]:
    """Return the curves of one scenario that is in the grade's recordings, one for each name.

    A field that is a single number gives one curve, named as the field. Messages without such a field or without names
    give none.
    """
    if quantity.state:
        return (_state_curve(grade, scenario, quantity),)
    run = Run(exercise, grade.recordings[scenario], grade.references[scenario])
    expected: dict[str, list[Point]] = {}
    got: dict[str, list[Point]] = {}
    moments = [(one.sent.at, one.expected, one.answers) for one in run.exchanges]
    if not moments:
        # It publishes on its own.
        its, mine = (run.published_on(quantity.topic, reference) for reference in (True, False))
        moments = [(Message(m).at, (Message(m),), ()) for m in its] + [(Message(m).at, (), (Message(m),)) for m in mine]
    try:
        for at, right, answers in moments:
            for lines, messages in ((expected, right), (got, answers)):
                for message in [one for one in messages if one.topic == quantity.topic]:
                    for element, value in _values(message, quantity).items():
                        lines.setdefault(str(element), []).append((at, _number(value)))
    except (LookupError, TypeError):
        return ()
    elements = [*expected, *(element for element in got if element not in expected)][:MOST]
    since = _first_finding(grade, scenario, [at for at, _, _ in moments])
    return tuple(_curve(element, expected.get(element, []), got.get(element, []), since) for element in elements)


def _state_curve(grade: Grade, scenario: str, quantity: Quantity) -> Curve:
    """Return what a world published of its state. The cross is at the first finding that has a time."""
    expected, got = (
        [
            ((message.at - START) / SECOND, _number(Message(message).value(quantity.field)))
            for message in runs[scenario].sent
            if message.topic == quantity.state
        ]
        for runs in (grade.references, grade.recordings)
    )
    at = _times_of_findings(grade, scenario)
    before = [point for point in _drawable(got) if at and point[0] <= at[0] + 1e-6]
    return Curve(quantity.field, _drawable(expected), _drawable(got), before[-1] if before else None)


def _times_of_findings(grade: Grade, scenario: str) -> list[float]:
    findings = [verdict.finding for verdict in grade.verdicts if verdict.status == "failed" and not verdict.hidden]
    return sorted(one.at for one in findings if one and one.scenario == scenario and one.at is not None)


def _first_finding(grade: Grade, scenario: str, times: list[float]) -> float:
    """Return the time of the last message before the first finding: an earlier difference is allowed."""
    at = next(iter(_times_of_findings(grade, scenario)), 0.0)
    return max((time for time in times if time <= at + 1e-9), default=at)


def _values(message: Message, quantity: Quantity) -> dict[str, object]:
    value = message.value(quantity.field)
    if isinstance(value, (int, float)):
        return {quantity.field: value}
    return message.by(quantity.named_by, quantity.field)


def _number(value: object) -> float:
    return float(value) if isinstance(value, (int, float)) else math.nan


def _curve(element: str, expected: list[Point], got: list[Point], since: float) -> Curve:
    return Curve(element, _drawable(expected), _drawable(got), _first_difference(dict(expected), dict(got), since))


def _drawable(points: list[Point]) -> tuple[Point, ...]:
    return tuple(point for point in points if abs(point[1]) < HIGHEST)


def _first_difference(expected: dict[float, float], got: dict[float, float], since: float) -> Point | None:
    for at in sorted(at for at in {*expected, *got} if at >= since):
        if at not in expected or at not in got or not equal(got[at], expected[at], 1e-6):
            shown = (value for value in (got.get(at), expected.get(at)) if value is not None and abs(value) < HIGHEST)
            return at, next(shown, 0.0)
    return None


#: In units of the picture, which is drawn as wide as its page allows.
WIDTH, LEFT, RIGHT, HEIGHT, GAP, TOP, BOTTOM = 500, 52, 8, 80, 34, 52, 12


@dataclass(frozen=True)
class Panel:
    """One element: the position of its panel, its two lines, the ends of its axis, and the first wrong point, if
    any.
    """

    element: str
    top: float
    expected: Markup
    got: Markup
    lowest: str
    highest: str
    wrong: Point | None
    wrong_at: str


def feedback_plot(grade: Grade, exercise: Exercise, *, judged: bool = True) -> str | None:
    """Return the plot as SVG text; None if nothing was recorded, or the node published nothing that can be drawn.

    Without `judged`, no value is marked as wrong.

    Return None also for a node that fails checks although its curves agree with the solution's: its fault is not in the
    picture. The plot shows the scenario of the first public check that failed, otherwise the first scenario, which all
    public checks may show. It never shows a hidden check's scenario.
    """
    scenario = _scenario(grade)
    if grade.outcome != "graded" or scenario is None:
        return None
    if path := path_of(grade, exercise, scenario):
        return path_plot(path)
    quantity = drawn_quantity(exercise, grade, scenario)
    drawn = curves(grade, exercise, scenario, quantity) if quantity else ()
    if not quantity or not any(curve.got for curve in drawn):
        return None
    if not grade.full_marks and not any(curve.first_wrong for curve in drawn):
        return None
    drawn = drawn if judged else tuple(replace(curve, first_wrong=None) for curve in drawn)
    times = [at for curve in drawn for line in (curve.expected, curve.got) for at, _ in line]
    start, end = min(times), max(times)
    panels = [_panel(i, curve, start, end) for i, curve in enumerate(drawn)]
    return template("report/feedback_plot.svg.j2").render(
        title=quantity.field,
        unit=quantity.unit,
        description=_description(drawn, quantity.field, quantity.element, end, judged),
        panels=panels,
        width=WIDTH,
        left=LEFT,
        right=WIDTH - RIGHT,
        panel_height=HEIGHT,
        height=TOP + len(panels) * (HEIGHT + GAP) + BOTTOM,
        bottom=TOP + len(panels) * (HEIGHT + GAP) - GAP,
        marks=[(_x(at, start, end), f"{at:g}") for at in round_values(start, end if end > start else start + 1.0)],
    )


def picture(grade: Grade, exercise: Exercise, *, judged: bool = True) -> str | None:
    """Return the plot, or None if there is nothing to draw or it can't be drawn.

    The numbers come from a student's node and may be anything: a page without a picture is better than no page.
    """
    try:
        return feedback_plot(grade, exercise, judged=judged)
    except Exception:
        return None


def _scenario(grade: Grade) -> str | None:
    public = [v for v in grade.verdicts if not v.hidden and v.status == "failed" and v.finding]
    failed = [v.finding.scenario for v in public if v.finding and v.finding.scenario in grade.recordings]
    return next(iter([*failed, *grade.recordings]), None)


def _panel(number: int, curve: Curve, start: float, end: float) -> Panel:
    top = float(TOP + number * (HEIGHT + GAP))
    values = [value for line in (curve.expected, curve.got) for _, value in line] or [0.0]
    low, high = min(values), max(values)
    margin = 0.08 * (high - low) or 0.5 * abs(high) or 1.0

    def place(point: Point) -> Point:
        share = (point[1] - low + margin) / (high - low + 2 * margin)
        return _x(point[0], start, end), round(top + HEIGHT * (1 - share), 1)

    return Panel(
        element=curve.element,
        top=top,
        expected=_line([place(point) for point in curve.expected]),
        got=_line([place(point) for point in curve.got]),
        lowest=f"{low:.3g}",
        highest=f"{high:.3g}" if high != low else "",
        wrong=place(curve.first_wrong) if curve.first_wrong else None,
        wrong_at=f"{curve.first_wrong[0]:.2f} s" if curve.first_wrong else "",
    )


def _x(at: float, start: float, end: float) -> float:
    return round(LEFT + (WIDTH - LEFT - RIGHT) * (at - start) / ((end - start) or 1.0), 1)


def _line(points: list[Point]) -> Markup:
    """Return points for an SVG. They are numbers, so nothing has to be escaped, and long lines are not cut."""
    return Markup(" ".join(f"{x:g},{y:g}" for x, y in points))


def _description(drawn: tuple[Curve, ...], field: str, called: str, end: float, judged: bool) -> str:
    """Describe the plot in words."""
    wrong = [curve for curve in drawn if curve.first_wrong]
    alone = drawn[0].element == field
    names = called if len(drawn) == 1 else f"{called}s"
    of = "" if alone else f" of {len(drawn)} {names}"
    begin = f"The {field}{of} over {end:.3g} s, yours drawn over the solution's. "
    if not wrong:
        return begin + ("They agree everywhere." if judged else "")
    times = [(curve.first_wrong[0], curve.element) for curve in wrong if curve.first_wrong]
    at, element = min(times)
    if alone:
        return begin + f"The first wrong value, at {at:.2f} s, is marked with a cross."
    first = f"the first wrong value, {element} at {at:.2f} s, is marked with a cross."
    return begin + f"{len(wrong)} of them {'differs' if len(wrong) == 1 else 'differ'}; {first}"
