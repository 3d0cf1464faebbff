"""nbgrader: submitted/STUDENT/ASSIGNMENT/, with a timestamp.txt.

Source of the layout: nbgrader's documentation, "The philosophy and the approach" and "Collecting submissions"; of the
columns: nbgrader/plugins/export.py, CsvExportPlugin.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from datetime import datetime, timezone
from functools import partial

from grader.classroom.formats.format import (
    Export,
    ExportTable,
    Format,
    Interpretation,
    Parts,
    UploadedFile,
    last_and_first,
    person,
)
from grader.classroom.submissions import SubmissionsError
from grader.classroom.tables import Cell, csv_text
from grader.classroom.times import UNKNOWN, Time, read_time
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry

SUBMITTED = "submitted"
TIMESTAMP = "timestamp.txt"
#: A folder in the exchange, before `nbgrader collect`: one per attempt.
EXCHANGE = re.compile(r"(?P<student>[^+]+)\+(?P<assignment>[^+]+)\+(?P<time>\d{4}-\d\d-\d\d [^+]+)(?:\+.+)?")


def read(export: Export) -> Callable[[Parts], Interpretation] | None:
    """Return how to read the paths, if the folder is `submitted` or has folders with the exercise's name.

    Raises `SubmissionsError` if `submitted` has several assignments, none of which is called like the exercise.
    """
    in_exchange = [match for parts in export.files if len(parts) > 1 and (match := EXCHANGE.fullmatch(parts[0]))]
    if 2 * len(in_exchange) > len(export.files):
        several = len({match["assignment"] for match in in_exchange}) > 1
        return partial(_in_exchange, export, export.exercise.name if several else "")
    assignments = {parts[1] for parts in export.files if len(parts) > 2}
    own = [name for name in assignments if name.casefold() == export.exercise.name.casefold()]
    if export.root != SUBMITTED and not own:
        return None
    # A course may use any name for the assignment, as long as there is only one.
    chosen = own or sorted(assignments)[:1]
    if len(assignments) > 1 and not own and all(len(parts) > 2 for parts in export.files):
        raise SubmissionsError(
            f"{SUBMITTED}/ has the assignments {', '.join(sorted(assignments))}, and none is called "
            f"{export.exercise.name}. Rename the folders of the right one, or, if these are not assignments, "
            "say --format folder."
        )
    times = {folder: _time(export, *folder) for folder in {parts[:2] for parts in export.files if len(parts) > 2}}

    def understand(parts: Parts) -> Interpretation:
        if len(parts) < 3:
            return None
        if parts[1] not in chosen:
            return f"another assignment, {parts[1]}"
        return UploadedFile((person(parts[0]),), parts[2:], time=times[parts[:2]], aside=parts[2:] == (TIMESTAMP,))

    return understand


def _in_exchange(export: Export, assignment: str, parts: Parts) -> Interpretation:
    match = EXCHANGE.fullmatch(parts[0])
    if not match or len(parts) < 2:
        return None
    if assignment and match["assignment"].casefold() != assignment.casefold():
        return f"another assignment, {match['assignment']}"
    time = read_time(match["time"], "nbgrader's exchange", timezone.utc, export.zone)
    aside = parts[1:] == (TIMESTAMP,)
    return UploadedFile((person(match["student"]),), parts[1:], match["time"], time, aside=aside)


def _time(export: Export, student: str, assignment: str) -> Time:
    if (student, assignment, TIMESTAMP) not in export.files:
        return UNKNOWN
    # nbgrader itself reads a time without a zone as UTC.
    return read_time(export.text(student, assignment, TIMESTAMP), TIMESTAMP, timezone.utc, export.zone)


def table(exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None) -> str:
    """Return the table that `nbgrader export` writes, with times in UTC.

    `late_submission_penalty` is the points lost for lateness, `raw_score` the score before that.
    """
    header = ["assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email", "raw_score"]
    rows: list[list[Cell]] = []
    for entry in entries:
        last, first = last_and_first(entry.student)
        penalty = -sum(a.points for a in entry.adjustments if a.kind == "late")
        raw = None if entry.final is None else entry.final + penalty
        rows.append(
            [
                *(exercise.name, _utc(due), _utc(entry.submitted), entry.student.id),
                *(last, first, entry.student.email, raw, None if raw is None else penalty),
                *(entry.final, entry.grade.points),
            ]
        )
    return csv_text([*header, "late_submission_penalty", "score", "max_score"], rows)


def _utc(moment: datetime | None) -> str:
    return str(moment.astimezone(timezone.utc).replace(tzinfo=None)) if moment else ""


FORMAT = Format(
    "nbgrader",
    "nbgrader's folder of submissions",
    read,
    inside=(SUBMITTED,),
    next_to=("source", "release", "autograded", "feedback", "nbgrader_config.py", "gradebook.db"),
    dates=f"Each STUDENT/ASSIGNMENT folder may have a {TIMESTAMP}.",
    table=ExportTable("nbgrader.csv", table),
)
