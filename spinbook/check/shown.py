"""A self-check as a notebook shows it: HTML, and the same in plain text for front ends without HTML."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from rich.console import Console

from grader.checking.wrong import Finding
from grader.exercise import Exercise
from grader.feedback import feedback_plot
from grader.feedback.told import Told, told
from grader.grading import Grade
from grader.report import self_check
from grader.report.printable import printable
from grader.report.terminal import show

#: Columns of the plain text.
WIDTH = 100

#: Of one text no more is shown: a student can publish a name of a megabyte.
LONGEST = 4000


@dataclass(frozen=True)
class Row:
    """One check as it is shown. `facts` are label and value; `remark` is what they leave out."""

    check: Told
    facts: tuple[tuple[str, str], ...]
    remark: str


def as_text(grade: Grade, exercise: Exercise) -> str:
    """What the terminal says, without colours."""
    out = io.StringIO()
    show(grade, exercise, Console(file=out, width=WIDTH, color_system=None, highlight=False))
    return "\n".join(line.rstrip() for line in out.getvalue().rstrip("\n").split("\n"))


def as_html(grade: Grade, exercise: Exercise) -> str:
    """A piece of HTML that needs nothing from outside and runs nothing, with everything of the student's escaped."""
    environment = Environment(
        loader=PackageLoader("spinbook.check", "."),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_harmless,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    plot = feedback_plot(grade, exercise)
    return environment.get_template("shown.html").render(
        title=exercise.title,
        total=self_check.total(grade),
        full=grade.full_marks,
        outcome=grade.outcome,
        message=grade.message,
        rows=[_row(check, grade) for check in told(grade)],
        # As an image an SVG can neither run nor load anything, whatever is in it.
        plot=Markup("data:image/svg+xml;base64,") + base64.b64encode(plot.encode()).decode() if plot else "",
        plot_says=_plot_says(grade),
        to_come=self_check.to_come(grade),
        standing=self_check.standing(grade),
    )


def _harmless(value: Any) -> Any:
    return printable(value, LONGEST) if isinstance(value, str) and not isinstance(value, Markup) else value


def _row(check: Told, grade: Grade) -> Row:
    if check.needs:
        return Row(check, (), "Can't be judged before this is right: " + " ".join(check.needs))
    if not check.finding:
        return Row(check, (), "")
    return Row(check, *_facts(check.finding, grade))


def _facts(finding: Finding, grade: Grade) -> tuple[tuple[tuple[str, str], ...], str]:
    """What is wrong as label and value, and what of the finding's text they leave out."""
    told = f"got {finding.got}."
    if not (finding.expected and finding.got and told in finding.text):
        return (), finding.text
    before, _, after = finding.text.partition(told)
    facts = [("expected", finding.expected), ("came", finding.got)]
    if finding.message is not None:
        recording = grade.recordings.get(finding.scenario)
        of = f" of {len(recording.sent)}" if recording else ""
        facts.append(("when", f"{finding.at or 0.0:.2f} s after the start (message {finding.message}{of})"))
        before = ""
    if finding.part:
        facts.append(("joint", finding.part))
    # "Your subscription has another type. Expected …" keeps its first sentence.
    remark = f"{before.rpartition('Expected ')[0].strip()} {after.strip()}".strip()
    return tuple(facts), remark


def _plot_says(grade: Grade) -> str:
    for check in told(grade):
        if check.finding and check.finding.message is not None:
            where = f", {check.finding.part}" if check.finding.part else ""
            return f"Yours over the solution's. First wrong: {check.finding.at or 0.0:.2f} s{where}."
    return "Yours over the solution's."
