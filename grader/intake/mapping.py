"""A CSV file that tells which file is whose: columns file, student, and where wanted name, email, submitted."""

from __future__ import annotations

from pathlib import Path

from grader.classroom import Skipped, Student
from grader.intake.folder import date_of
from grader.intake.handed_in import File, IntakeError, Sorted, student_id
from grader.intake.moment import moment
from grader.intake.table import rows

NEEDED = ("file", "student")
KNOWN = (*NEEDED, "name", "email", "submitted")


def by_row(table: Path) -> Sorted:
    """The files that the rows name, found from the CSV file's folder. Raises `IntakeError` for a row with a mistake.

    Columns beyond those known are kept for each student, as their learning platform's.
    """
    found, skipped = [], []
    for number, row in rows(table, NEEDED):
        if not row["student"] or not row["file"]:
            raise IntakeError(f"{table}:{number}: file = {row['file']!r}, student = {row['student']!r}. Give both.")
        path = table.parent / row["file"]
        if not path.is_file() and not path.is_symlink():
            skipped.append(Skipped(row["file"], f"line {number} names it, but there is no such file"))
            continue
        if row.get("submitted"):
            date, told_by = moment(row["submitted"]), "the CSV file"
            if date is None:
                given = row["submitted"]
                raise IntakeError(f"{table}:{number}: submitted = {given!r}. Write it as 2026-11-22 23:59.")
        else:
            date, told_by = date_of(path), "the file's date"
        lms = {column: value for column, value in row.items() if column not in KNOWN}
        student = Student(student_id(row["student"]), row.get("name", ""), row.get("email", ""), lms)
        found.append((student, File(row["file"], path, date, told_by)))
    return Sorted(f"the files that {table.name} names", tuple(found), tuple(skipped))
