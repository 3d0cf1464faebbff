"""A grade as a picture of its own: what the node published over what the solution published, in one scenario."""

from __future__ import annotations

import re
from pathlib import Path

from markupsafe import Markup

from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade
from grader.report.feedback_plot import scenario_plot
from grader.report.pages import template
from groundwork.files import write_if_changed

NOTHING = "--plot: there is nothing to draw, no number that changes on a topic of exercise.toml."


def draw(grade: Grade, exercise: Exercise, file: Path, scenario: str = "") -> bool:
    """Draw a scenario of the grade into `file`, as SVG: by default the first that went wrong.

    Return False, and write nothing, if there is nothing to draw. Raises OSError if the file can't be written.
    """
    svg = scenario_picture(grade, exercise, scenario or _first_wrong(grade))
    if svg:
        write_if_changed(file, svg)
    return svg is not None


def scenario_picture(grade: Grade, exercise: Exercise, scenario: str, *, judged: bool = True) -> str | None:
    """Return the plot of a scenario as SVG text with a heading and a background; None if there is nothing to draw.

    Without `judged`, no value is marked as wrong.
    """
    drawing = scenario_plot(grade, exercise, scenario, judged=judged) if scenario in grade.recordings else None
    if not drawing:
        return None
    width, height = map(int, re.findall(r"\d+", drawing.partition('viewBox="0 0 ')[2])[:2])
    heading = f"{exercise.title}: {scenario}"
    return template("report/picture.svg.j2").render(
        heading=heading, width=width, height=height, drawing=Markup(drawing)
    )


def _first_wrong(grade: Grade) -> str:
    scenarios = [v.finding.scenario for v in grade.verdicts if v.finding and v.finding.scenario]
    return next((name for name in scenarios if name in grade.recordings), next(iter(grade.recordings), ""))
