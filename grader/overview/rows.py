"""What the instructor's page tells of each student and of each check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from urllib.parse import quote

from grader.checking.verdict import Verdict
from grader.classroom.entry import Entry
from grader.classroom.store import STUDENTS
from grader.misconception import Misconceptions

OUTCOMES = {
    "graded": "",
    "did-not-start": "did not start",
    "crashed": "crashed",
    "timed-out": "hung",
    "over-limit": "over a limit",
    "host-error": "not graded",
}


@dataclass(frozen=True)
class Row:
    """One student's row."""

    entry: Entry
    name: str
    page: str
    outcome: str
    failed: tuple[Verdict, ...]
    blocked: int
    mistakes: tuple[str, ...]

    @property
    def adjusted(self) -> float:
        """All adjustments together, in points."""
        return sum(adjustment.points for adjustment in self.entry.adjustments)


@dataclass(frozen=True)
class Tally:
    """One check: how many students fail it, and for how many it can't be judged, in numbers and in percent."""

    verdict: Verdict
    failed: int
    blocked: int
    share: float


def page_of(entry: Entry) -> str:
    """Where a student's page lies, as seen from the instructor's."""
    return f"{STUDENTS}/{quote(entry.student.id, safe='')}/feedback.html"


def row(entry: Entry, misconceptions: Misconceptions) -> Row:
    """What the page tells of `entry`."""
    verdicts = entry.grade.verdicts
    return Row(
        entry=entry,
        name=entry.student.name or entry.student.id,
        page=page_of(entry),
        outcome=OUTCOMES[entry.grade.outcome],
        failed=tuple(verdict for verdict in verdicts if verdict.status == "failed"),
        blocked=sum(verdict.status == "blocked" for verdict in verdicts),
        mistakes=tuple(signature.sentence for signature in misconceptions.of(entry)),
    )


def tallies(entries: Sequence[Entry]) -> tuple[Tally, ...]:
    """The checks that students fail, most failed first; of those who did not come through nothing is counted."""
    graded = [entry.grade for entry in entries if entry.grade.outcome == "graded"]
    checks = {verdict.name: verdict for grade in graded for verdict in grade.verdicts}
    counted = []
    for name, check in checks.items():
        statuses = [verdict.status for grade in graded for verdict in grade.verdicts if verdict.name == name]
        failed, blocked = statuses.count("failed"), statuses.count("blocked")
        counted.append(Tally(check, failed, blocked, round(100 * failed / len(graded), 1)))
    return tuple(
        sorted((tally for tally in counted if tally.failed), key=lambda tally: (-tally.failed, -tally.blocked))
    )
