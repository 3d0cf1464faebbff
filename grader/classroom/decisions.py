"""What only the instructor can decide. The command asks before it grades, so no student is left out silently."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rich.console import Console

from grader.classroom.class_display import say
from grader.classroom.deadline import Adjuster
from grader.classroom.submissions import Submissions, Unclear
from grader.submission.submission import Submission
from groundwork.words import counted


@dataclass(frozen=True)
class Decision:
    """One thing to decide: what it is, the files or students it concerns, and what to do."""

    what: str
    about: tuple[str, ...]
    remedy: str


#: What is unclear, and what to do.
QUESTION_TEXTS: dict[Unclear, tuple[str, str, str]] = {
    "name": (
        "{} could be graded, but the student is unknown: the name does not fit the format of the others",
        "entry",
        "Rename or remove them, name them in a CSV file, or choose how to read the class with --format.",
    ),
    "attempts": (
        "{} handed in several times",
        "student",
        "Say which attempt counts, for everybody: --attempts last, first or best.",
    ),
    "files": ("{} handed in several files", "student", "Keep one of them, or name it in a CSV file."),
    "absent": (
        "{} that the CSV file names is not there",
        "file",
        "Put it there, or remove its row. Everybody in a --roster has a row in the gradebook.",
    ),
    "damaged": (
        "{} can't be read out of the zip",
        "file",
        "Download the zip again, or put the files into it without a password.",
    ),
}


def decisions(
    collected: Submissions, adjuster: Adjuster, submissions: Mapping[str, Sequence[Submission]]
) -> list[Decision]:
    """Return what is not clear about a class. `submissions` are those of `collected` after reading, by student."""
    programs = [f"{who}: {one.question}" for who, tries in submissions.items() for one in tries if one.question]
    unread = [f"{s.student.id}: {file.time.fault}" for s in collected.handed_in for file in s.files if file.time.fault]
    questions: dict[Unclear, list[str]] = {unclear: [] for unclear in QUESTION_TEXTS}
    for question in collected.questions:
        questions[question.unclear].append(str(question))
    found = [
        Decision(sentence.format(counted(len(texts), of)), tuple(texts), remedy)
        for texts, (sentence, of, remedy) in ((texts, QUESTION_TEXTS[unclear]) for unclear, texts in questions.items())
    ]
    found += [
        Decision(
            f"{counted(len(unread), 'time')} of submission can't be read",
            tuple(unread),
            "Write them as 2026-11-22 23:59:00 UTC, or give them in a table with --roster.",
        ),
        Decision(
            f"{counted(len(programs), 'submission')}: what to run is not clear",
            tuple(programs),
            "If the student must say which program counts, keep only that one.",
        ),
        Decision(
            "the roster seems to name students otherwise than the files do",
            tuple(dict.fromkeys(collected.mismatches.values())),
            "Write the names of the files into the roster's column student, or rename the files. If a pair is two "
            "people, add the one who handed in to the roster.",
        ),
        _undated(collected, adjuster),
    ]
    return [decision for decision in found if decision.about]


def _undated(collected: Submissions, adjuster: Adjuster) -> Decision:
    undated = [one for one in adjuster.undated(collected.handed_in) if not one.file.time.fault]
    late = [one for one in undated if one.file.time.late]
    marked = f", {counted(len(late), 'student')} marked as late" if late else ""
    return Decision(
        f"exercise.toml has a [deadline], but the dates of {counted(len(undated), 'submission')} are unknown{marked}",
        tuple(f"{one.student.id}: {one.file.name}" for one in undated),
        f"{collected.dates} Give a table with --roster that has the columns student (or those of your platform's list) "
        "and submitted, set points with --overrides, or remove [deadline].".strip(),
    )


def show_decisions(console: Console, found: Sequence[Decision], skip: bool) -> None:
    """Print every decision in full, with what to do."""
    for decision in found:
        say(console, f"{decision.what}:", "yellow")
        for about in decision.about:
            say(console, f"  {about}")
        say(console, f"  {decision.remedy}")
    if found and not skip:
        say(console, "Nothing was graded. Decide, or grade all others with --skip.", "bold")
