"""A CSV file that tells which file is whose: columns file, student, and where wanted name, email, submitted."""

from __future__ import annotations

import csv
import io
from datetime import datetime, timezone
from pathlib import Path

from grader.classroom import Skipped, Student
from grader.intake.handed_in import File, IntakeError, Sorted, student_id
from grader.intake.moment import moment

NEEDED = ("file", "student")
KNOWN = (*NEEDED, "name", "email", "submitted")


def by_row(table: Path) -> Sorted:
    """The files that the rows name, found from the CSV file's folder. Raises `IntakeError` for a row with a mistake.

    Columns beyond those known are kept for each student, as their learning platform's.
    """
    rows = _rows(table)
    found, skipped = [], []
    for number, row in rows:
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
            date, told_by = datetime.fromtimestamp(path.lstat().st_mtime, timezone.utc), "the file's date"
        lms = {column: value for column, value in row.items() if column not in KNOWN}
        student = Student(student_id(row["student"]), row.get("name", ""), row.get("email", ""), lms)
        found.append((student, File(row["file"], path, date, told_by)))
    return Sorted(f"the files that {table.name} names", tuple(found), tuple(skipped))


def _rows(table: Path) -> list[tuple[int, dict[str, str]]]:
    try:
        text = table.read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise IntakeError(f"{table}: it can't be read: {error}. Save it as CSV in UTF-8.") from None
    first = text.partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    reader = csv.DictReader(io.StringIO(text), delimiter=delimiter, restval="")
    columns = [column.strip() for column in reader.fieldnames or []]
    for column in NEEDED:
        if column not in columns:
            there = ", ".join(columns) or "none"
            raise IntakeError(f"{table}:1: there is no column {column!r} (there are: {there}).")
    reader.fieldnames = columns
    try:
        return [(reader.line_num, {column: (row[column] or "").strip() for column in columns}) for row in reader]
    except csv.Error as error:
        raise IntakeError(f"{table}:{reader.line_num}: {error}") from None
