"""A grade as a picture: what the node published over what the solution published, one panel per element."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade
from grader.report.curves import Curve, Point, Quantity, curves, drawn_quantity
from grader.report.path_plot import PlanePath, path_of
from grader.report.printable import printable
from groundwork.files import write_if_changed

NOTHING = "--plot: there is nothing to draw, no number that changes on a topic of exercise.toml."
#: The same grade gives the same file: no date, and identifiers made from a fixed salt.
SETTINGS: dict[Any, Any] = {"svg.hashsalt": "spinbook", "svg.fonttype": "none", "font.family": "sans-serif"}


def draw(grade: Grade, exercise: Exercise, file: Path, scenario: str = "") -> bool:
    """Draw a scenario of the grade into `file` (.svg, .png or .pdf): by default the first that went wrong.

    Each panel shows one element over simulated time; the first sample that differs is marked. Return False if there is
    nothing to draw, and the picture has only a title. Raises OSError when the file can't be written.
    """
    drawing = figure(grade, exercise, scenario or _first_wrong(grade))
    _save(drawing, file)
    return bool(drawing.axes)


def figure(grade: Grade, exercise: Exercise, name: str, *, judged: bool = True) -> Figure:
    """Return the picture of the scenario `name`, which need not be in the grade's recordings.

    Without `judged`, no sample is marked as wrong.
    """
    quantity = drawn_quantity(exercise, grade, name)
    drawing = Figure(figsize=(9, 1.2), layout="constrained")
    if name in grade.recordings and (path := path_of(grade, exercise, name)):
        _path(drawing, path)
        quantity = None
    drawn = curves(grade, exercise, name, quantity) if quantity and name in grade.recordings else ()
    if quantity and drawn:
        _panels(drawing, drawn if judged else [replace(one, first_wrong=None) for one in drawn], quantity)
    drawing.suptitle(f"{exercise.title}: {name or grade.outcome}", fontsize=11)
    return drawing


def _panels(figure: Figure, drawn: Sequence[Curve], quantity: Quantity) -> None:
    figure.set_size_inches(9, 1.2 + 1.5 * len(drawn))
    panels = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)[:, 0]
    for panel, curve in zip(panels, drawn, strict=True):
        _panel(panel, curve)
        panel.set_ylabel(f"{quantity.field}\n({quantity.unit})" if quantity.unit else quantity.field)
    named = {line.get_label(): line for panel in panels for line in panel.lines}
    figure.legend(list(named.values()), list(named), loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    figure.align_ylabels()
    panels[-1].set_xlabel("simulated time (s)")


def _path(figure: Figure, path: PlanePath) -> None:
    figure.set_size_inches(6, 6)
    panel = figure.subplots()
    panel.set_aspect("equal", adjustable="datalim")
    panel.set_xlabel(f"{path.fields[0]} ({path.unit})")
    panel.set_ylabel(f"{path.fields[1]} ({path.unit})")
    panel.plot(*_columns(path.expected), color="#999999", linewidth=3, label="solution")
    panel.plot(*_columns(path.got), color="#0b6efd", linewidth=1, label="yours")
    panel.plot(*_columns(path.goals), "o", color="#1a7f37", markersize=12, fillstyle="none", label="goal")
    if path.wrong:
        at, place = path.wrong
        panel.plot(*_columns([place]), "x", color="#d00000", markersize=10, markeredgewidth=2, label="went wrong")
        panel.annotate(f"{at:.2f} s", place, color="#d00000", textcoords="offset points", xytext=(8, 4))
    figure.legend(loc="outside lower center", ncols=4, fontsize=8, frameon=False)


def _panel(panel: Axes, curve: Curve) -> None:
    panel.set_title(printable(curve.element, 60), fontsize=9, loc="left", parse_math=False)
    panel.plot(*_columns(curve.expected), color="#999999", linewidth=3, label="solution")
    panel.plot(*_columns(curve.got), color="#0b6efd", linewidth=1, marker=".", markersize=3, label="yours")
    if wrong := curve.first_wrong:
        panel.plot([wrong[0]], [wrong[1]], "x", color="#d00000", markersize=10, markeredgewidth=2, label="first wrong")
        panel.annotate(
            f"{wrong[0]:.2f} s", wrong, color="#d00000", fontsize=8, textcoords="offset points", xytext=(8, 4)
        )


def _columns(points: Sequence[Point]) -> tuple[list[float], list[float]]:
    return [at for at, _ in points], [value for _, value in points]


def _first_wrong(grade: Grade) -> str:
    scenarios = [v.finding.scenario for v in grade.verdicts if v.finding and v.finding.scenario]
    return next((name for name in scenarios if name in grade.recordings), next(iter(grade.recordings), ""))


def _save(figure: Figure, file: Path) -> None:
    kind = file.suffix.lower().removeprefix(".") or "svg"
    picture = io.BytesIO()
    with mpl.rc_context(SETTINGS):
        figure.savefig(picture, format=kind, metadata={"Date": None} if kind == "svg" else None)
    write_if_changed(file, picture.getvalue())
