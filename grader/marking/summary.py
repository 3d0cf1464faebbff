"""What the instructor is told at the end of a run."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from grader.classroom import Entry, Skipped
from grader.gradebook.tables import unknown_to_moodle
from grader.intake import Question
from grader.report.printable import printable

#: How many files that were skipped for one reason are named; the overview page names all.
MOST_NAMED = 5


def tell_intake(console: Console, kind: str, count: int, skipped: Sequence[Skipped]) -> None:
    """Say as what the submissions were read, and what was left out of them."""
    _say(console, f"{count} submissions in {kind}.")
    reasons: dict[str, list[str]] = {}
    for one in skipped:
        reasons.setdefault(one.why, []).append(one.file)
    for why, files in reasons.items():
        more = f" and {len(files) - MOST_NAMED} more" if len(files) > MOST_NAMED else ""
        _say(console, f"skipped, {why}: {', '.join(files[:MOST_NAMED])}{more}", "yellow")


def tell_end(
    console: Console, entries: Sequence[Entry], faults: Sequence[Entry], questions: Sequence[Question]
) -> None:
    """Say what the class came to, and what is left to do for the instructor."""
    finals = sorted(entry.final for entry in entries if entry.final is not None)
    if finals:
        points = entries[0].grade.points
        middle = (finals[(len(finals) - 1) // 2] + finals[len(finals) // 2]) / 2
        full = sum(final >= points for final in finals)
        _say(console, f"{len(finals)} grades: median {middle:g} of {points:g} points, {full} with full marks.", "bold")
    if entries and (unknown := unknown_to_moodle(entries)):
        who = "no student" if unknown == len(entries) else f"not {unknown} of the {len(entries)} students"
        _say(
            console,
            f"moodle.csv: Moodle will find {who}, for lack of an Identifier. If you use Moodle, grade its own "
            "download, or a CSV file with the column Identifier.",
            "dim",
        )
    for question in questions:
        _say(console, f"not graded: {question} Keep one of them, or name it in a CSV file.", "yellow")
    for entry in faults:
        _say(
            console,
            f"not graded, a fault of ours or the machine's: {entry.student.id}: {entry.grade.message}",
            "red",
        )
    if faults:
        _say(console, "The same command tries them again.", "red")


def _say(console: Console, text: str, style: str = "") -> None:
    console.print(Text(printable(text), style=style), soft_wrap=True)
