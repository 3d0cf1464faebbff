"""The instructor's page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from grader.classroom.entry import Entry, Skipped
from grader.exercise import Exercise
from grader.misconception import Misconceptions
from grader.overview.distribution import distribution
from grader.overview.rows import OUTCOMES, page_of, row, tallies
from grader.pages import render


def overview_page(
    exercise: Exercise,
    entries: Sequence[Entry],
    skipped: Sequence[Skipped],
    faults: Sequence[Entry],
    misconceptions: Misconceptions,
) -> str:
    """The page `results/index.html`: how the class did, a row a student, which checks and mistakes cost most.

    `entries` have a score; `faults` are those that have none, by a fault of ours. Each row opens
    `students/STUDENT/feedback.html` beside the page. The page is one HTML file; its one script sorts the table,
    which is in order without it, too.
    """
    faulty = [*faults, *(entry for entry in entries if entry.final is None and entry not in faults)]
    scored = [entry for entry in entries if entry.final is not None]
    rows = [row(entry, misconceptions) for entry in scored]
    rows.sort(key=lambda row: (row.name.casefold(), row.entry.student.id))
    broken = Counter(OUTCOMES[entry.grade.outcome] for entry in scored if entry.grade.outcome != "graded")
    scores = [entry.final for entry in scored if entry.final is not None]
    return render(
        "overview/overview.html",
        script=_script(),
        exercise=exercise,
        rows=rows,
        distribution=distribution(scores, scored[0].grade.points) if scored else None,
        most=scored[0].grade.points if scored else exercise.points,
        tallies=tallies(scored),
        misconceptions=misconceptions,
        broken=broken,
        skipped=skipped,
        faults=faulty,
        page_of=page_of,
        several=sum(len(misconceptions.of(entry)) > 1 for entry in scored),
    )


@cache
def _script() -> str:
    return (Path(__file__).parent / "sort.js").read_text(encoding="utf-8")
