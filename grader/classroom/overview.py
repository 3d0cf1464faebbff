"""The instructor's page about a class."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from urllib.parse import quote

from grader.checking.verdict import Verdict
from grader.classroom.misconceptions import Misconceptions
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry, SkippedFile
from grader.report.as_json import STUDENTS
from grader.report.pages import points, render

OUTCOMES = {
    "graded": "",
    "did-not-start": "did not start",
    "crashed": "crashed",
    "timed-out": "hung",
    "over-limit": "over a limit",
    "host-error": "not graded",
    "missing": "nothing handed in",
    "undecided": "undecided",
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
        """The sum of all adjustments, in points."""
        return sum(adjustment.points for adjustment in self.entry.adjustments)


@dataclass(frozen=True)
class Tally:
    """How many students fail a check, and for how many it can't be judged, as numbers and in percent."""

    verdict: Verdict
    failed: int
    blocked: int
    share: float


def page_of(entry: Entry) -> str:
    """Return the link from the instructor's page to a student's page."""
    return f"{STUDENTS}/{quote(entry.student.id, safe='')}/feedback.html"


def row(entry: Entry, misconceptions: Misconceptions) -> Row:
    """Return what the page shows for `entry`."""
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
    """Return the checks that students fail, most failed first; runs that did not complete are not counted."""
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


BINS = 10

#: Sizes of the histogram, in the units of its SVG.
WIDTH, HEIGHT, TOP, BOTTOM, GAP = 640.0, 200.0, 24.0, 26.0, 6.0


@dataclass(frozen=True)
class Bar:
    """One bar of the histogram: how many students got from `low` to `high` points, and where it is drawn."""

    low: float
    high: float
    count: int
    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True)
class Distribution:
    """What the page says about the points of a class."""

    count: int
    mean: float
    median: float
    full: int
    bars: tuple[Bar, ...]
    description: str


def distribution(scores: Sequence[float], most: float) -> Distribution | None:
    """Return the distribution of `scores`, with `most` for full marks; None for an empty class.

    Ten bins of equal width; the last holds full marks and anything above.
    """
    if not scores:
        return None
    counts = [0] * BINS
    for score in scores:
        counts[min(BINS - 1, int(BINS * score / most))] += 1
    bars = tuple(_bar(i, count, max(counts), most) for i, count in enumerate(counts))
    text = [f"{bar.count} from {points(bar.low)} to {points(bar.high)}" for bar in bars if bar.count]
    return Distribution(
        count=len(scores),
        mean=statistics.fmean(scores),
        median=statistics.median(scores),
        full=sum(score >= most for score in scores),
        bars=bars,
        description=f"Histogram of {len(scores)} students' points: " + ", ".join(text) + ".",
    )


def _bar(i: int, count: int, highest: int, most: float) -> Bar:
    width = WIDTH / BINS
    height = (HEIGHT - TOP - BOTTOM) * count / highest
    y = HEIGHT - BOTTOM - height
    return Bar(
        i * most / BINS, (i + 1) * most / BINS, count, i * width + GAP / 2, round(y, 1), width - GAP, round(height, 1)
    )


def overview_page(
    exercise: Exercise,
    entries: Sequence[Entry],
    skipped: Sequence[SkippedFile],
    faults: Sequence[Entry],
    misconceptions: Misconceptions,
) -> str:
    """Return the page `results/index.html`: the results, a row per student, and the most frequent failures.

    `entries` have a score; `faults` have none, because of a fault of ours or an open decision. Each row links to
    `students/STUDENT/feedback.html` next to the page. The page is one HTML file; its one script sorts the table,
    which is also sorted without it.
    """
    rows = [row(entry, misconceptions) for entry in entries]
    rows.sort(key=lambda row: (row.name.casefold(), row.entry.student.id))
    broken = Counter(OUTCOMES[entry.grade.outcome] for entry in entries if entry.grade.outcome != "graded")
    scores = [entry.final for entry in entries if entry.final is not None]
    return render(
        "classroom/overview.html",
        script="classroom/sort.js",
        exercise=exercise,
        rows=rows,
        distribution=distribution(scores, entries[0].grade.points) if entries else None,
        most=entries[0].grade.points if entries else exercise.points,
        tallies=tallies(entries),
        misconceptions=misconceptions,
        broken=broken,
        skipped=skipped,
        faults=[entry for entry in faults if entry.grade.outcome != "undecided"],
        undecided=[entry for entry in faults if entry.grade.outcome == "undecided"],
        page_of=page_of,
        several=sum(len(misconceptions.of(entry)) > 1 for entry in entries),
    )
