"""The plot on a feedback page: one panel per element, the student's curve over the solution's, as a small SVG."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from markupsafe import Markup

from grader.exercise.exercise import Exercise
from grader.report.curves import Curve, Point, curves, drawn_quantity
from grader.report.pages import template
from grader.report.path_plot import path_of, path_plot
from ros_in_python.axis_marks import round_values

if TYPE_CHECKING:
    from grader.grading.grade import Grade

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
    return scenario_plot(grade, exercise, scenario, judged=judged, only_telling=True)


def scenario_plot(
    grade: Grade, exercise: Exercise, scenario: str, *, judged: bool = True, only_telling: bool = False
) -> str | None:
    """Return the plot of any scenario in the grade's recordings as SVG text; None if there is nothing to draw, or
    `only_telling` is set and the curves don't show what is wrong.
    """
    if path := path_of(grade, exercise, scenario):
        return path_plot(path)
    quantity = drawn_quantity(exercise, grade, scenario)
    drawn = curves(grade, exercise, scenario, quantity) if quantity else ()
    shows_it = any(curve.got for curve in drawn) and (grade.full_marks or any(curve.first_wrong for curve in drawn))
    if not quantity or not drawn or (only_telling and not shows_it):
        return None
    drawn = drawn if judged else tuple(replace(curve, first_wrong=None) for curve in drawn)
    times = [at for curve in drawn for line in (curve.expected, curve.got) for at, _ in line] or [0.0]
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
