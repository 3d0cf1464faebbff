"""A grade for people."""

from __future__ import annotations

from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from grader.checking.verdict import Status, Verdict
from grader.exercise import Exercise
from grader.grading import Grade
from grader.report import self_check
from grader.report.printable import as_students_see_it, printable

SIGNS: dict[Status, tuple[str, str]] = {
    "passed": ("✓", "green"),
    "failed": ("✗", "red"),
    "blocked": ("–", "yellow"),
    "error": ("!", "magenta"),
}


def show(grade: Grade, exercise: Exercise, console: Console, verbose: bool = False) -> None:
    """Print a grade: every check with its points, and for what failed why, and where to look."""
    console.print(Text(printable(f"{exercise.title}: {grade.submission}"), style="bold"), soft_wrap=True)
    if grade.message:
        console.print(Text(printable(f"{grade.outcome}: {grade.message}"), style="red"), soft_wrap=True)
    for verdict in grade.verdicts:
        _show_verdict(verdict, grade, console)
    if grade.outcome != "host-error":
        style = "bold green" if grade.full_marks else "bold"
        if grade.self_check:
            first, *rest = self_check.lines(grade)
            console.print(Text(first, style=style), *(Text(line) for line in rest), sep="\n", soft_wrap=True)
        else:
            console.print(Text(f"{grade.score:g} of {grade.points:g} points", style=style))
    made_by = f"isolation: {grade.isolation}, middleware: {grade.versions['middleware']}"
    console.print(Text(made_by, style="dim"))
    if verbose:
        console.print(Text("the node's log:", style="bold"))
        console.print(Text(printable(as_students_see_it(grade.log)) or "(nothing)"), soft_wrap=True)


def _show_verdict(verdict: Verdict, grade: Grade, console: Console) -> None:
    sign, style = SIGNS[verdict.status]
    points = f"{verdict.earned:g}/{verdict.points:g}"
    console.print(Text.assemble((f" {sign} ", style), (f"{points:>6}  ", "dim"), verdict.title), soft_wrap=True)
    lines = []
    if verdict.status == "failed":
        # The story of a run that broke off stands at the top already.
        if verdict.finding and grade.outcome == "graded":
            lines.append(verdict.finding.text)
        if grade.outcome == "graded":
            lines.append(f"Hint: {verdict.hint}")
    elif verdict.status == "blocked" and grade.outcome == "graded":
        titles = {other.name: other.title for other in grade.verdicts}
        lines.append("Can't be judged before this is right: " + " ".join(titles[name] for name in verdict.blocked_by))
    elif verdict.status == "error":
        lines.append(verdict.error)
    for line in lines:
        if line:
            console.print(
                Padding(Text(printable(line), style="dim" if line.startswith("Can't") else ""), (0, 0, 0, 11))
            )
