"""Prints how a class was read, the progress of grading, and the result."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Sequence

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from grader.classroom.formats.moodle import unknown_to_moodle
from grader.classroom.submissions import Submissions
from grader.grading.grade import Entry, SkippedFile
from grader.report.printable import printable
from groundwork.words import counted

#: At most this many skipped files are named per reason; the overview page names all of them.
MOST_NAMED = 5


def say(console: Console, text: str, style: str = "") -> None:
    """Print a line, without control sequences that a terminal would obey."""
    console.print(Text(printable(text), style=style), soft_wrap=True)


def show_submissions(console: Console, collected: Submissions) -> None:
    """Print how the submissions were read and what was left out; the first line is the count and the format."""
    asked = [question for question in collected.questions if question.unclear != "name"]
    students = len(collected.handed_in) + len(asked)
    submissions = len({one.file.path for one in collected.handed_in}) + len(asked)
    shared = f", with {counted(submissions, 'submission')}" if submissions < students else ""
    say(console, f"{counted(students, 'student')} in {collected.kind}{shared}.")
    if collected.missing:
        names = ", ".join(student.id for student in collected.missing)
        say(console, f"{counted(len(collected.missing), 'student')} handed in nothing: {names}")
    for note in collected.notes:
        say(console, note, "yellow")
    _list(console, collected.skipped)


def _list(console: Console, skipped: Iterable[SkippedFile]) -> None:
    reasons: dict[str, list[str]] = {}
    for one in skipped:
        reasons.setdefault(one.why, []).append(one.file)
    for why, files in reasons.items():
        more = f" and {len(files) - MOST_NAMED} more" if len(files) > MOST_NAMED else ""
        say(console, f"skipped, {why}: {', '.join(files[:MOST_NAMED])}{more}", "yellow")


def show_result(console: Console, entries: Sequence[Entry], unscored: Sequence[Entry], kind: str) -> None:
    """Print the class's result, and what is left for the instructor to do; `kind` says how the class was read."""
    finals = [entry.final for entry in entries if entry.final is not None]
    if finals:
        points = entries[0].grade.points
        full = sum(final >= points for final in finals)
        median = statistics.median(finals)
        late = sum(any(a.kind == "late" and a.points for a in entry.adjustments) for entry in entries)
        after = f", after {counted(late, 'late submission')} lost points" if late else ""
        result = f"median {median:g} of {points:g} points, {full} with full marks{after}"
        say(console, f"{len(finals)} grades: {result}.", "bold")
    unknown = unknown_to_moodle(entries)
    if unknown and (unknown < len(entries) or "Moodle" in kind):  # a class that Moodle knows
        say(
            console,
            f"moodle.csv has no Identifier for {unknown} of the {len(entries)} students, so Moodle can't match them. "
            "Give its grading worksheet with --roster.",
            "dim",
        )
    for entry in unscored:
        undecided = entry.grade.outcome == "undecided"
        why = "needs your decision" if undecided else "not graded, because of a fault of Spinbook or the machine"
        say(console, f"{why}: {entry.student.id}: {entry.grade.message}", "yellow" if undecided else "red")
    if any(entry.grade.outcome != "undecided" for entry in unscored):
        say(console, "Run the same command to try them again.", "red")


class ProgressDisplay:
    """Prints each entry when it is done. Use it as a context manager."""

    def __init__(self, console: Console, total: int) -> None:
        self._console, self._total, self._done = console, total, 0
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(compact=True),
            console=console,
            disable=not console.is_terminal,
            transient=True,
        )
        self._task = self._bar.add_task("grading", total=total)

    def done(self, entry: Entry, changed: str) -> None:
        """Count one more entry as done; `changed` describes the difference from an earlier grade, if any."""
        self._done += 1
        self._bar.update(self._task, advance=1)
        if self._console.is_terminal and not changed:
            return
        grade = entry.grade
        score = f"{grade.score:g} of {grade.points:g} points" if grade.has_score else "not graded"
        text = f"{self._done}/{self._total} {entry.student.id}: {changed or score}"
        if grade.has_score and not changed:
            text += f", {entry.final:g} after adjustments" if entry.final != grade.score else ""
            text += f" ({grade.outcome})" if grade.outcome != "graded" else ""
        say(self._console, text)

    def __enter__(self) -> ProgressDisplay:
        self._bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._bar.stop()
