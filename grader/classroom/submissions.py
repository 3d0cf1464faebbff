"""The submissions of a class, as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Literal

from grader.classroom.times import UNKNOWN, Time
from grader.grading.grade import SkippedFile, Student


class SubmissionsError(Exception):
    """Raised if a class's submissions, or a table about them, can't be read; the text is for the instructor."""


@dataclass(frozen=True)
class File:
    """A submitted file or folder. `name` is its path in the class's folder or zip, `path` its path on disk.

    `fault` says why it can't be read out of the class's zip.
    """

    name: str
    path: Path
    time: Time = UNKNOWN
    fault: str = ""

    @property
    def submitted(self) -> datetime | None:
        """When it was handed in, with a time zone; None if unknown."""
        return self.time.at

    @property
    def submitted_from(self) -> str:
        """The source of that time, such as "timestamp.txt"."""
        return self.time.source


@dataclass(frozen=True)
class StudentSubmission:
    """One student's submission. `others` are the student's other attempts, if the best attempt counts."""

    student: Student
    file: File
    others: tuple[File, ...] = ()

    @property
    def files(self) -> tuple[File, ...]:
        """All of the student's attempts that may count, the last one first."""
        return (self.file, *self.others)


#: Several files in one attempt; several attempts; a file that can't be read from the zip; a file whose name does not
#: fit the platform's format.
Unclear = Literal["files", "attempts", "damaged", "name", "absent"]


@dataclass(frozen=True)
class Question:
    """A question that only the instructor can answer: which of a student's files counts, or whose they are."""

    student: Student
    files: tuple[str, ...]
    unclear: Unclear = "files"
    why: str = ""

    def __str__(self) -> str:
        """Return the question as text."""
        names = ", ".join(self.files)
        if self.unclear == "name":
            return f"{names}: {self.why}"
        if self.unclear in ("damaged", "absent"):
            return f"{self.student.id} handed in {names}: {self.why}"
        return f"{self.student.id} handed in {len(self.files)} {self.unclear}: {names}. Which one counts?"


@dataclass(frozen=True)
class Submissions:
    """What a class submitted, sorted by student; what was left out and why; and the open questions.

    `kind` says in words how it was read, such as "a download from Moodle". `missing` are students of the roster who
    submitted nothing. `notes` say how something ambiguous was read, `dates` where the platform keeps dates, and
    `mismatches` which of the missing the roster may name otherwise than the files do, by id, and what suggests it.
    """

    kind: str
    handed_in: tuple[StudentSubmission, ...]
    skipped: tuple[SkippedFile, ...]
    questions: tuple[Question, ...]
    missing: tuple[Student, ...] = ()
    notes: tuple[str, ...] = ()
    dates: str = ""
    mismatches: Mapping[str, str] = field(default_factory=dict)

    @property
    def students(self) -> tuple[Student, ...]:
        """All students: those who handed something in, and those who did not."""
        theirs = [one.student for one in self.handed_in] + [question.student for question in self.questions]
        return tuple(sorted([*theirs, *self.missing], key=lambda student: student.id))
