"""A grade as a picture: the student's velocities over the solution's, a panel a joint."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from grader.checking import Run
from grader.checking.comparator import equal
from grader.exercise import Exercise
from grader.files import write_if_changed
from grader.grading import Grade
from grader.report.printable import printable

#: The same picture each time: no date in it, and identifiers made from a fixed salt.
SETTINGS: dict[Any, Any] = {"svg.hashsalt": "spinbook", "svg.fonttype": "none", "font.family": "sans-serif"}

#: The highest value that is drawn.
HIGHEST = 1e9

Line = dict[str, list[tuple[float, float]]]


def draw(grade: Grade, exercise: Exercise, file: Path, scenario: str = "", per: str = "name") -> None:
    """Draw a scenario of the grade into `file` (.svg, .png or .pdf): by default the first that went wrong.

    Each panel shows one joint over simulated time; the first sample that differs is marked. Raises OSError when the
    file can't be written.
    """
    field, unit = _drawn(exercise)
    name = scenario or _first_wrong(grade)
    figure = Figure(figsize=(9, 1.2), layout="constrained")
    if name and name in grade.recordings:
        run = Run(exercise, grade.recordings[name], grade.references[name])
        _panels(figure, run, field, unit, per)
    figure.suptitle(f"{exercise.title}: {name or grade.outcome}", fontsize=11)
    _save(figure, file)


def _panels(figure: Figure, run: Run, field: str, unit: str, per: str) -> None:
    expected: Line = {}
    got: Line = {}
    for exchange in run.exchanges:
        for lines, messages in ((expected, exchange.expected), (got, exchange.answers)):
            for message in messages:
                for joint, value in message.by(per, field).items():
                    lines.setdefault(str(joint), []).append((exchange.sent.at, _drawable(value)))
    joints = [*expected, *(joint for joint in got if joint not in expected)][:24]
    figure.set_size_inches(9, 1.2 + 1.5 * len(joints))
    if not joints:
        return
    panels = figure.subplots(len(joints), 1, sharex=True, squeeze=False)[:, 0]
    for panel, joint in zip(panels, joints, strict=True):
        _panel(panel, joint, expected.get(joint, []), got.get(joint, []))
        panel.set_ylabel(unit)
    named = {line.get_label(): line for panel in panels for line in panel.lines}
    figure.legend(list(named.values()), list(named), loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    figure.align_ylabels()
    panels[-1].set_xlabel("simulated time (s)")


def _panel(panel: Axes, joint: str, expected: list[tuple[float, float]], got: list[tuple[float, float]]) -> None:
    panel.set_title(printable(joint, 60), fontsize=9, loc="left", parse_math=False)
    panel.plot(*_columns(expected), color="#999999", linewidth=3, label="solution")
    panel.plot(*_columns(got), color="#0b6efd", linewidth=1, marker=".", markersize=3, label="yours")
    wrong = _first_difference(expected, got)
    if wrong:
        panel.plot([wrong[0]], [wrong[1]], "x", color="#d00000", markersize=10, markeredgewidth=2, label="first wrong")
        panel.annotate(
            f"{wrong[0]:.2f} s", wrong, color="#d00000", fontsize=8, textcoords="offset points", xytext=(8, 4)
        )


def _first_difference(
    expected: list[tuple[float, float]], got: list[tuple[float, float]]
) -> tuple[float, float] | None:
    right, came = dict(expected), dict(got)
    for at in sorted({*right, *came}):
        if at not in right or at not in came or not equal(came[at], right[at], 1e-6):
            shown = came.get(at, math.nan)
            return at, shown if math.isfinite(shown) else right.get(at, 0.0)
    return None


def _drawable(value: float) -> float:
    """`value`, or NaN (a gap in the line) where no axis could show it."""
    return value if isinstance(value, (int, float)) and abs(value) < HIGHEST else math.nan


def _columns(points: list[tuple[float, float]]) -> tuple[list[float], list[float]]:
    return [at for at, _ in points], [value for _, value in points]


def _drawn(exercise: Exercise) -> tuple[str, str]:
    for topic in exercise.outputs:
        for field, unit in topic.units.items():
            return field, f"{field}\n({unit})"
    return "velocity", "velocity"


def _first_wrong(grade: Grade) -> str:
    scenarios = [v.finding.scenario for v in grade.verdicts if v.finding and v.finding.scenario]
    return next((name for name in scenarios if name in grade.recordings), next(iter(grade.recordings), ""))


def _save(figure: Figure, file: Path) -> None:
    kind = file.suffix.lower().removeprefix(".") or "svg"
    picture = io.BytesIO()
    with mpl.rc_context(SETTINGS):
        figure.savefig(picture, format=kind, metadata={"Date": None} if kind == "svg" else None)
    write_if_changed(file, picture.getvalue())
