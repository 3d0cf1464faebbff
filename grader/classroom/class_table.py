"""A class as a CSV file: one row per file, with its student."""

from __future__ import annotations

from collections import defaultdict
from datetime import tzinfo
from pathlib import Path

from grader.classroom.archive import date_of
from grader.classroom.formats.format import UploadedFile, person
from grader.classroom.names import normal
from grader.classroom.submissions import File, Question, SubmissionsError
from grader.classroom.tables import table_rows
from grader.classroom.times import UNKNOWN, Time, read_time
from grader.grading.grade import SkippedFile, Student

NEEDED = ("file", "student")
KNOWN = (*NEEDED, "name", "email", "submitted", "attempt")


def by_row(
    table: Path, zone: tzinfo | None
) -> tuple[list[tuple[File, UploadedFile]], list[SkippedFile], list[Question]]:
    """Return the files that the rows name, relative to the CSV file's folder, and the rows whose file is missing: a
    question if it is the student's only one.

    Times without a zone are in `zone`. Several files of a student are attempts if each has a time, or a number in the
    column attempt. Other columns are kept as the student's data from the learning platform. Raises
    `SubmissionsError` for a row with a mistake.
    """
    uploads: dict[str, list[tuple[File, UploadedFile]]] = defaultdict(list)
    absent: list[tuple[Student, SkippedFile]] = []
    for number, row in table_rows(table, NEEDED, KNOWN):
        if not row["student"] or not row["file"]:
            raise SubmissionsError(
                f"{table}:{number}: file = {row['file']!r}, student = {row['student']!r}. Give both."
            )
        path = table.parent / row["file"]
        if not path.exists():
            path = table.parent / row["file"].replace("\\", "/")
        if not path.exists() and path.parent.is_dir():  # a Mac writes ü as two characters
            path = next((one for one in path.parent.iterdir() if normal(one.name) == normal(path.name)), path)
        lms = {column: value for column, value in row.items() if column not in KNOWN}
        student = person(row["student"], row.get("name", ""), row.get("email", ""), **lms)
        if not path.exists() and not path.is_symlink():
            absent.append((student, SkippedFile(row["file"], f"line {number} names it, but there is no such file")))
            continue
        time = _time(row, path, f"{table}:{number}", zone)
        attempt = row.get("attempt", "").zfill(4) if row.get("attempt") else ""
        if not attempt and row.get("submitted") and time.at:
            attempt = str(time.at.timestamp()).zfill(20)
        upload = UploadedFile((student,), (path.name,), attempt, time)
        uploads[student.id].append((File(row["file"], path), upload))
    skipped = [skip for student, skip in absent if student.id in uploads]
    questions = [
        Question(student, (skip.file,), "absent", skip.why) for student, skip in absent if student.id not in uploads
    ]
    return [upload for theirs in uploads.values() for upload in _attempts(theirs)], skipped, questions


def _time(row: dict[str, str], path: Path, place: str, zone: tzinfo | None) -> Time:
    if "submitted" not in row:
        return date_of(path)
    if not row["submitted"]:
        return UNKNOWN
    time = read_time(row["submitted"], "the CSV file", zone, zone)
    if time.fault:
        raise SubmissionsError(f"{place}: submitted = {row['submitted']!r}. Write it as 2026-11-22 23:59.")
    return time


def _attempts(theirs: list[tuple[File, UploadedFile]]) -> list[tuple[File, UploadedFile]]:
    """Return a student's files; as attempts only if the order of all of them is known."""
    known = [upload.attempt for _, upload in theirs]
    if len(set(known)) == len(known) and all(known):
        return theirs
    return [(file, UploadedFile(upload.students, upload.inside, "", upload.time)) for file, upload in theirs]
