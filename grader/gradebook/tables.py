"""The tables: our own, nbgrader's, Canvas's and Moodle's, with the columns that each of them reads."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime, timezone
from html import escape

from grader.classroom.entry import Entry
from grader.exercise import Exercise
from grader.feedback.told import told
from grader.gradebook.names import last_and_first, last_first
from grader.gradebook.table import Cell, csv_text, number


def grades(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """Everything, for people and their spreadsheets: a row a student, a column a check at the end."""
    checks = list(dict.fromkeys(verdict.name for entry in entries for verdict in entry.grade.verdicts))
    header = ["student", "name", "email", "points", "of", "before adjustments", "adjustments", "outcome", "failed"]
    rows: list[list[Cell]] = []
    for entry in entries:
        grade, earned = entry.grade, {verdict.name: verdict.earned for verdict in entry.grade.verdicts}
        host = grade.outcome == "host-error"
        adjustments = "; ".join(f"{a.kind} {a.points:+g}: {a.reason}" for a in entry.adjustments)
        failed = ", ".join(verdict.name for verdict in grade.verdicts if verdict.status == "failed")
        rows.append(
            [
                *(entry.student.id, entry.student.name, entry.student.email, entry.final, grade.points),
                *(None if host else grade.score, adjustments, grade.outcome, failed, grade.message),
                *(entry.file, entry.submitted.isoformat() if entry.submitted else ""),
                *(None if host else earned.get(name) for name in checks),
            ]
        )
    return csv_text([*header, "message", "file", "submitted", *checks], rows)


def nbgrader(exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None) -> str:
    """What `nbgrader export` writes (nbgrader/plugins/export.py, CsvExportPlugin): its columns, times in UTC.

    `late_submission_penalty` is what was taken for lateness, `raw_score` the score before that.
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


def canvas(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """What Canvas exports and imports (canvas-lms, lib/gradebook_exporter.rb and gradebook_importer.rb).

    What Canvas calls a student comes from `Student.lms`; Canvas finds students by ID, else by SIS User ID, SIS Login
    ID, name. The assignment's column is the one of `lms` that is called as Canvas calls assignments, "Name (1234)", or
    else the exercise's title, from which Canvas makes a new assignment. Without a score the cell stays empty, and
    Canvas leaves the grade as it is.
    """
    given = [name for entry in entries for name in entry.student.lms]
    assignment = next((name for name in given if re.fullmatch(r".+ \(\d+\)", name)), exercise.title)
    identity = ["ID", *(["SIS User ID"] if "SIS User ID" in given else []), "SIS Login ID", "Section"]
    points = entries[0].grade.points if entries else exercise.points
    rows: list[list[Cell]] = [["    Points Possible", *[None] * len(identity), points]]
    for entry in entries:
        lms = entry.student.lms
        login = lms.get("SIS Login ID", "" if "ID" in lms else entry.student.id)
        cells = {**lms, "SIS Login ID": login}
        name = lms.get("Student") or last_first(entry.student)
        rows.append([name, *(cells.get(column, "") for column in identity), entry.final])
    return csv_text(["Student", *identity, assignment], rows)


def moodle(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """Moodle's offline grading worksheet (mod/assign/feedback/offline/importgradeslib.php), to upload as it is.

    Moodle finds students by Identifier, "Participant 1234567", which only Moodle's own download or a table can tell: it
    is empty where neither did, and Moodle then finds nobody. It leaves out a row whose grade is above the maximum,
    so extra credit is cut off there, and told in the comment; and a row without a grade, so a fault of ours changes
    nothing. Columns of a worksheet that was read are given back as they were.
    """
    columns = ["Identifier", "Full name", "Email address", "Status", "Grade", "Maximum Grade"]
    columns += ["Grade can be changed", "Last modified (submission)", "Last modified (grade)", "Feedback comments"]
    rows: list[list[Cell]] = []
    for entry in entries:
        final, points = entry.final, entry.grade.points
        cells: dict[str, Cell] = {
            "Identifier": "",
            "Full name": entry.student.name,
            "Email address": entry.student.email,
            "Status": "Submitted for grading",
            "Grade can be changed": "Yes",
            "Last modified (submission)": "-",
            "Last modified (grade)": "-",
            **{name: value for name, value in entry.student.lms.items() if name in columns},
            "Grade": None if final is None else min(final, points),
            "Maximum Grade": points,
            "Feedback comments": _comment(entry),
        }
        rows.append([cells[column] for column in columns])
    return csv_text(columns, rows)


def unknown_to_moodle(entries: Sequence[Entry]) -> int:
    """Return how many students Moodle can't find, because nothing has told how Moodle identifies them."""
    return sum(not entry.student.lms.get("Identifier") for entry in entries)


def _comment(entry: Entry) -> str:
    """What a student reads on a platform, as the HTML that Moodle expects of comments."""
    grade, final = entry.grade, entry.final
    if final is None:
        return ""
    lines = [f"{number(final)} of {number(grade.points)} points."]
    lines += [f"{a.points:+g}: {a.reason}" for a in entry.adjustments]
    if grade.message:
        lines.append(grade.message[:500])
    for check in told(grade):
        if check.status == "failed" and (check.finding or check.hint):
            lines.append(f"✗ {check.title}" + (f" Hint: {check.hint}" if check.hint else ""))
    return "<br>".join(escape(line) for line in lines)


def _utc(moment: datetime | None) -> str:
    return str(moment.astimezone(timezone.utc).replace(tzinfo=None)) if moment else ""
