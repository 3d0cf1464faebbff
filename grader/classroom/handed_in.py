"""What was submitted, as plain data, and the tables and times that instructors write."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from grader.grading.grade import Skipped, Student
from grader.submission.reading import MOST_BYTES

#: What can be a submission; each has its reader in grader/submission/reading.py.
SUFFIXES = tuple(MOST_BYTES)


class SubmissionsError(Exception):
    """Raised when the source contains no class's submissions, or can't be read; the text is for the instructor."""


@dataclass(frozen=True)
class File:
    """A submitted file. `name` is its name in the class's folder or zip, `path` where it is."""

    name: str
    path: Path
    submitted: datetime | None
    submitted_from: str

    @property
    def parts(self) -> tuple[str, ...]:
        """The folders that it is in, and its own name."""
        return tuple(self.name.split("/"))

    @property
    def can_be_graded(self) -> bool:
        """Whether submissions can be of this kind."""
        return self.name.endswith(SUFFIXES)


@dataclass(frozen=True)
class HandedIn:
    """One student's one file."""

    student: Student
    file: File


@dataclass(frozen=True)
class Question:
    """Several files from one student; only the instructor can say which one counts."""

    student: Student
    files: tuple[str, ...]

    def __str__(self) -> str:
        """Return the question as text."""
        return f"{self.student.id} handed in {len(self.files)} files: {', '.join(self.files)}. Which one counts?"


@dataclass(frozen=True)
class Submissions:
    """What a class submitted, sorted by student; what was left out, and why; and the questions to ask.

    `kind` says in words how it was read, such as "a download from Moodle".
    """

    kind: str
    handed_in: tuple[HandedIn, ...]
    skipped: tuple[Skipped, ...]
    questions: tuple[Question, ...]


@dataclass(frozen=True)
class Sorted:
    """Files, sorted by student, before it is decided which one counts."""

    kind: str
    files: tuple[tuple[Student, File], ...]
    skipped: tuple[Skipped, ...] = ()


def student_id(text: str) -> str:
    """Return `text` as a name that a folder can have on any system: letters, digits and `.@+-_`."""
    kept = re.sub(r"[^\w.@+-]+", "_", text).strip("._")
    while len(kept.encode("utf-8", errors="replace")) > 120:
        kept = kept[:-1]
    return kept or "nameless"


def moment(text: str) -> datetime | None:
    """Return the time in `2026-11-22 23:59` or any ISO 8601 form, by default in local time. None for other texts."""
    try:
        # Python 3.10 does not accept Z.
        written = datetime.fromisoformat(text.strip().replace("Z", "+00:00"))
        return written if written.tzinfo else written.astimezone()
    except (ValueError, OverflowError):
        return None


def table_rows(table: Path, needed: Sequence[str]) -> list[tuple[int, dict[str, str]]]:
    """Return the rows, each with its line number; values without the spaces around them. Empty rows are left out.

    Commas, semicolons or tabs separate columns. Raises `SubmissionsError` if the file can't be read or lacks a column.
    """
    try:
        text = table.read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise SubmissionsError(f"{table}: it can't be read: {error}. Save it as CSV in UTF-8.") from None
    first = text.partition("\n")[0]
    reader = csv.DictReader(io.StringIO(text), delimiter=max(",;\t", key=first.count), restval="")
    columns = [column.strip() for column in reader.fieldnames or []]
    for column in needed:
        if column not in columns:
            there = ", ".join(columns) or "none"
            raise SubmissionsError(f"{table}:1: there is no column {column!r} (there are: {there}).")
    reader.fieldnames = columns
    try:
        found = [(reader.line_num, {column: (row[column] or "").strip() for column in columns}) for row in reader]
    except csv.Error as error:
        raise SubmissionsError(f"{table}:{reader.line_num}: {error}") from None
    return [(number, row) for number, row in found if any(row.values())]
