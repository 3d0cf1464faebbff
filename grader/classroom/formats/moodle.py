"""Moodle: NAME_NUMBER_assignsubmission_file/, and its grading worksheet.

Source of the names: mod/assign/classes/downloader.php, earlier mod/assign/locallib.php: a folder per student, with an
underscore at the end before Moodle 4, or one folder of files. A team's folder is called `Team_NUMBER`, in earlier
versions `Team-NAME_NUMBER` per member. files/classes/local/archive_writer/zip_writer.php writes no dates. Source of the
table: mod/assign/feedback/offline/importgradeslib.php.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from html import escape

from grader.classroom.formats.format import Export, ExportTable, Format, Interpretation, Parts, UploadedFile, person
from grader.classroom.formats.moodle_languages import COLUMNS, LANGUAGE, LANGUAGES
from grader.classroom.tables import Cell, csv_text
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry, Student
from grader.report.checks import shown_checks
from grader.report.pages import points

NAME = re.compile(r"(?P<name>.+?)(?:_(?P<number>\d+))?_assignsubmission_(?P<kind>[a-z]+)(?:_(?P<file>.*))?", re.DOTALL)


def read(export: Export) -> Callable[[Parts], Interpretation]:
    """Return how to read the names that Moodle gives to folders or files."""
    names = {match["name"] for parts in export.files if (match := NAME.fullmatch(parts[0]))}
    teams = {name.partition("-")[0] for name in names}
    # Earlier versions put the team's name before each member's: then every name has one, and some share theirs.
    in_teams = all("-" in name for name in names) and 2 * len(teams) <= len(names)

    def understand(parts: Parts) -> Interpretation:
        match = NAME.fullmatch(parts[0])
        if not match or (len(parts) == 1 and not match["file"]):
            return None
        team, _, rest = match["name"].partition("-")
        name = rest if in_teams else match["name"]
        student = _student(name, match["number"] or "", "", {"Group": team} if in_teams else {})
        return UploadedFile((student,), parts[1:] or (match["file"],), aside=match["kind"] != "file")

    return understand


def _student(name: str, number: str, email: str, more: Mapping[str, str]) -> Student:
    lms = {"Identifier": f"Participant {number}", "Full name": name} if number else {}
    return person("_".join(filter(None, (name, number))), name, email, **{**lms, **more})


def of_row(row: Mapping[str, str]) -> Student | None:
    """Return the student in a row of the grading worksheet."""
    if not row.get("Identifier") or not {"Full name", "Last modified (submission)"} & row.keys():
        return None
    label, _, number = row["Identifier"].rpartition(" ")  # the only name in blind marking
    return _student(row.get("Full name", label.replace("/", "")), number, row.get("Email address", ""), row)


def table(exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None) -> str:
    """Return Moodle's offline grading worksheet, ready to upload, in the language of the worksheet that was read.

    Moodle finds students by Identifier, "Participant 1234567", which is only in Moodle's own download or a table: it is
    empty if neither had it, and Moodle then does not find the student. Moodle ignores rows whose grade is above the
    maximum, so extra credit is cut off, and the comment says so. It also ignores rows without a grade, so a fault of
    ours changes nothing. The columns of a worksheet that was read are returned, in its order.
    """
    language = next((one for entry in entries if (one := entry.student.lms.get(LANGUAGE))), "")
    worksheet = next((entry.student.lms for entry in entries if COLUMNS[-1] in entry.student.lms), COLUMNS)
    columns = [column for column in worksheet if column != LANGUAGE]
    rows: list[list[Cell]] = []
    for entry in entries:
        final, most = entry.final, entry.grade.points
        cells: dict[str, Cell] = {
            "Identifier": "",
            "Full name": entry.student.name,
            "Email address": entry.student.email,
            "Status": "No submission" if entry.grade.outcome == "missing" else "Submitted for grading",
            "Grade can be changed": "Yes",
            "Last modified (submission)": "-",
            "Last modified (grade)": "-",
            **{name: value for name, value in entry.student.lms.items() if name in columns},
            "Grade": None if final is None else min(final, most),
            "Maximum Grade": most,
            "Feedback comments": _comment(entry),
        }
        rows.append([cells.get(column, "") for column in columns])
    return csv_text([LANGUAGES.get(language, {}).get(column, column) for column in columns], rows)


def unknown_to_moodle(entries: Sequence[Entry]) -> int:
    """Return how many students Moodle can't find, because their Moodle identifier is unknown."""
    return sum(not entry.student.lms.get("Identifier") for entry in entries)


def _comment(entry: Entry) -> str:
    """Return the feedback comment, as the HTML that Moodle expects."""
    grade, final = entry.grade, entry.final
    if final is None:
        return ""
    lines = [f"{points(final)} of {points(grade.points)} points."]
    lines += [f"{a.points:+g}: {a.reason}" for a in entry.adjustments]
    if grade.message:
        lines.append(grade.message[:500])
    for check in shown_checks(grade):
        if check.status == "failed" and (check.finding or check.hints or check.same_as):
            hint = f"Hint: {check.hints[0]}" if check.hints else ""
            lines.append(" ".join(filter(None, (f"✗ {check.title}", hint, check.note))))
    return "<br>".join(escape(line) for line in lines)


FORMAT = Format(
    "moodle",
    "a download from Moodle",
    read,
    of_row=of_row,
    dates="Moodle's download has no dates; its grading worksheet has them.",
    table=ExportTable("moodle.csv", table),
)
