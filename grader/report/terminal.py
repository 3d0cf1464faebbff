"""Shows a grade as text, on a terminal and in self-checks."""

from __future__ import annotations

from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from grader.checking.verdict import Status, Verdict
from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade
from grader.report.printable import as_students_see_it, printable
from grader.sandbox.program import Isolation


def points_so_far(grade: Grade) -> str:
    """Return how many of the checks that can be judged here passed: "8 of 8 public checks, 50 of 50 points"."""
    passed = sum(verdict.status == "passed" for verdict in grade.verdicts)
    return f"{passed} of {len(grade.verdicts)} public checks, {grade.score:g} of {grade.points:g} points"


def hidden_checks_to_come(grade: Grade) -> str:
    """Return what is judged later; empty if all checks are public."""
    count = grade.hidden_checks
    if not count:
        return ""
    return f"{count} hidden check{'s' * (count > 1)} ({grade.hidden_points:g} points) will be judged after you hand in."


def self_check_standing(grade: Grade) -> str:
    """Return that this is not a grade, and how the code ran."""
    text = "This is a self-check, not your grade."
    if grade.isolation == Isolation.NONE.value:
        text += " Your code ran without a sandbox, and no grade of record is made that way."
    return text


def self_check_lines(grade: Grade) -> list[str]:
    """Return the whole result of a self-check, as lines."""
    return [
        line for line in (f"{points_so_far(grade)}.", hidden_checks_to_come(grade), self_check_standing(grade)) if line
    ]


SIGNS: dict[Status, tuple[str, str]] = {
    "passed": ("✓", "green"),
    "failed": ("✗", "red"),
    "blocked": ("–", "yellow"),
    "error": ("!", "magenta"),
}


def show(grade: Grade, exercise: Exercise, console: Console, verbose: bool = False) -> None:
    """Print a grade: every check with its points, and for each failed one why, and where to look."""
    console.print(Text(printable(f"{exercise.title}: {grade.submission}"), style="bold"), soft_wrap=True)
    if grade.message:
        console.print(Text(printable(f"{grade.outcome}: {grade.message}"), style="red"), soft_wrap=True)
    for verdict in grade.verdicts:
        _show_verdict(verdict, grade, console)
    if grade.has_score:
        style = "bold green" if grade.full_marks else "bold"
        if grade.self_check:
            first, *rest = self_check_lines(grade)
            console.print(Text(first, style=style), *(Text(line) for line in rest), sep="\n", soft_wrap=True)
        else:
            console.print(Text(f"{grade.score:g} of {grade.points:g} points", style=style))
    console.print(Text(f"isolation: {grade.isolation}", style="dim"))
    if verbose:
        console.print(Text("the node's log:", style="bold"))
        console.print(Text(printable(as_students_see_it(grade.log)) or "(nothing)"), soft_wrap=True)


def _show_verdict(verdict: Verdict, grade: Grade, console: Console) -> None:
    sign, style = SIGNS[verdict.status]
    points = f"{verdict.earned:g}/{verdict.points:g}"
    console.print(Text.assemble((f" {sign} ", style), (f"{points:>6}  ", "dim"), verdict.title), soft_wrap=True)
    lines = []
    if verdict.status == "failed":
        # The message of a run that broke off is already at the top.
        if verdict.finding and grade.outcome == "graded":
            lines.append(verdict.finding.text)
        if grade.outcome == "graded":
            lines.append(f"Hint: {verdict.hint}")
    elif verdict.status == "blocked" and grade.outcome == "graded":
        titles = {other.name: other.title for other in grade.verdicts}
        lines.append("Can't be judged until this is right: " + " ".join(titles[name] for name in verdict.blocked_by))
    elif verdict.status == "error":
        lines.append(verdict.error)
    for line in lines:
        if line:
            console.print(
                Padding(Text(printable(line), style="dim" if line.startswith("Can't") else ""), (0, 0, 0, 11))
            )
