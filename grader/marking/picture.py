"""The picture for a student's page."""

from __future__ import annotations

from grader.exercise import Exercise
from grader.feedback.plot import feedback_plot
from grader.grading import Grade


def picture(grade: Grade, exercise: Exercise) -> str | None:
    """What the node published over what the solution did, as SVG; None where there is nothing to draw."""
    try:
        return feedback_plot(grade, exercise)
    except Exception:  # of data that a student chose; a page without a picture is better than no page
        return None
