"""Shows a grade as text, on a terminal and in self-checks."""

from __future__ import annotations

from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from grader.checking.verdict import Verdict
from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade
from grader.recording.printed_paths import without_paths
from grader.report.checks import ShownCheck, public_total, shown_checks
from grader.report.printable import printable
from grader.sandbox.program import Isolation
from groundwork.words import counted


def hidden_checks_to_come(grade: Grade) -> str:
    """Return what is judged later; empty if all checks are public."""
    count = grade.hidden_checks
    if not count:
        return ""
    return f"{counted(count, 'hidden check')} ({grade.hidden_points:g} points) will be judged after you hand in."


def self_check_standing(grade: Grade) -> str:
    """Return that this is not a grade, and how the code ran."""
    text = "This is a self-check, not your grade."
    if grade.isolation == Isolation.NONE.value:
        text += " Your code ran without a sandbox, and no grade of record is made that way."
    return text


def self_check_lines(grade: Grade) -> list[str]:
    """Return the whole result of a self-check, as lines."""
    return [
        line
        for line in (f"{public_total(grade.verdicts)}.", hidden_checks_to_come(grade), self_check_standing(grade))
        if line
    ]


STYLES: dict[str, str] = {"✓": "green", "✗": "red", "–": "yellow", "!": "magenta", "○": "cyan"}


def show(grade: Grade, exercise: Exercise, console: Console, verbose: bool = False, steps: int = 2) -> None:
    """Print a grade: every check with its points, and for each failed one why, once for each cause.

    `steps` is how much of a hint is shown: 1 is what was seen, 2 also where to look, 3 also what to do.
    """
    console.print(Text(printable(f"{exercise.title}: {grade.submission}"), style="bold"), soft_wrap=True)
    if grade.message:
        console.print(Text(printable(f"{grade.outcome}: {grade.message}"), style="red"), soft_wrap=True)
    checks = shown_checks(grade)
    for check, verdict in zip(checks, grade.verdicts, strict=True):
        _show_check(check, verdict, console, steps)
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
        console.print(Text(printable(without_paths(grade.log)) or "(nothing)"), soft_wrap=True)


def _show_check(check: ShownCheck, verdict: Verdict, console: Console, steps: int) -> None:
    points = f"{check.earned:g}/{check.points:g}"
    sign = (f" {check.sign} ", STYLES[check.sign])
    console.print(Text.assemble(sign, (f"{points:>6}  ", "dim"), check.title), soft_wrap=True)
    # Only instructors see hidden checks here, and they see the findings, too.
    said = verdict.finding if check.finding or (check.hidden and check.hints) else None
    lines = [(said.text, "")] if said else []
    lines += [(f"{label}: {hint}", "") for label, hint in check.labelled_hints[: steps - 1]]
    lines += [(check.note, "dim"), (verdict.error, "")]
    for line, style in lines:
        if line:
            console.print(Padding(Text(printable(line), style=style), (0, 0, 0, 11)))
