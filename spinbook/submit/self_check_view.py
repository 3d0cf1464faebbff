"""A self-check as a notebook shows it: as HTML, and as plain text for front ends without HTML."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from importlib import resources

from markupsafe import Markup
from rich.console import Console

from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade
from grader.recording.printed_paths import without_paths
from grader.report import terminal
from grader.report.checks import ShownCheck, first_hints, public_total, shown_checks
from grader.report.facts import facts, plot_says
from grader.report.feedback import advice
from grader.report.feedback_plot import feedback_plot
from grader.report.pages import environment
from grader.report.printable import printable
from grader.report.terminal import show

#: Columns of the plain text.
WIDTH = 100

#: The longest text that is shown (characters): a student can publish a name of a megabyte.
LONGEST = 4000

#: How many lines of a node's output the plain text shows.
LAST_LINES = 12


@dataclass(frozen=True)
class CheckRow:
    """One check as it is shown. `facts` are (label, value); `remark` is the rest of the finding."""

    check: ShownCheck
    facts: tuple[tuple[str, str], ...] = ()
    remark: str = ""


def as_text(grade: Grade, exercise: Exercise) -> str:
    """Return the text that the terminal shows, without colours."""
    out = io.StringIO()
    show(grade, exercise, Console(file=out, width=WIDTH, color_system=None, highlight=False), steps=1)
    lines = [line.rstrip() for line in out.getvalue().rstrip("\n").split("\n")]
    if printed := _end(grade.log):
        last = printed.splitlines()[-LAST_LINES:]
        lines += ["What your program printed:", *(f"  {printable(line, WIDTH)}" for line in last)]
    lines += [more_help(exercise)] if first_hints(grade)[1] else []
    return "\n".join([*lines, f"Next: {next_step(grade, exercise)}"])


def more_help(exercise: Exercise) -> str:
    """Return how to get the further hints in a notebook."""
    counted = ", and each one is counted" if exercise.count_hints else ""
    return f"More help: %hint {exercise.name} shows where to look, and then what to do{counted}."


def next_step(grade: Grade, exercise: Exercise) -> str:
    """Return what a beginner should do next."""
    if grade.full_marks:
        return f"hand in. Type %submit {exercise.name} into a new cell and run it."
    if grade.outcome == "host-error":
        return "run this cell again."
    if grade.outcome == "undecided":
        return "keep only one of them, run its cell, then this one again."
    node = exercise.file_name.removesuffix(".py")
    step = "fix the first ✗" if grade.outcome == "graded" else "fix that"
    return f"{step}, run the cell that begins with %%node {node}, then this one again."


def as_html(grade: Grade, exercise: Exercise) -> str:
    """Return HTML that loads and runs nothing, with all text from the student escaped."""
    plot = feedback_plot(grade, exercise)
    page = environment(_source).get_template("self_check_view.html")
    return page.render(
        title=exercise.title,
        total=public_total(grade.verdicts),
        full=grade.full_marks,
        message=grade.message,
        step=_first_step(grade, exercise),
        log=_end(grade.log),
        log_open=grade.outcome != "graded",
        rows=[_row(check, grade, exercise) for check in shown_checks(grade)],
        fold_hints=not exercise.count_hints,
        # In an <img>, an SVG can neither run nor load anything.
        plot=Markup("data:image/svg+xml;base64,") + base64.b64encode(plot.encode()).decode() if plot else "",
        plot_says=plot_says(shown_checks(grade), plot) if plot else "",
        more_help=more_help(exercise) if first_hints(grade)[1] else "",
        next_step=next_step(grade, exercise),
        to_come=terminal.hidden_checks_to_come(grade),
        standing=terminal.self_check_standing(grade),
    )


def _source(name: str) -> str:
    return (resources.files("spinbook.submit") / name).read_text(encoding="utf-8")


def _first_step(grade: Grade, exercise: Exercise) -> str:
    """Return the first step to take with a program that failed. The other steps are about files, not cells."""
    advised = advice(grade, exercise)
    return advised.steps[0] if advised else ""


def _end(log: str) -> str:
    """Return the end of a log, which shows why the program ended."""
    return without_paths(log).strip()[-LONGEST:]


def _row(check: ShownCheck, grade: Grade, exercise: Exercise) -> CheckRow:
    if not check.finding:
        return CheckRow(check)
    return CheckRow(check, *facts(check.finding, grade.recordings, exercise.element_name))
