"""What a format is: how it reads the names in a class's export, and the table of grades that its platform imports."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, tzinfo

from grader.classroom.names import normal
from grader.classroom.submissions import File
from grader.classroom.times import UNKNOWN, Time
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry, Student

#: A file's path in the export, as its parts.
Parts = tuple[str, ...]


@dataclass(frozen=True)
class UploadedFile:
    """What a file's path says: whose it is, which attempt, its path inside the submission, and when it was submitted.

    A student's `id` is unique in the export. `attempt` is empty if there is only one; attempts are sorted by these
    texts. A file that is `aside`, such as a text typed on the platform or a time stamp, counts only if the student
    handed in nothing else.
    """

    students: tuple[Student, ...]
    inside: Parts
    attempt: str = ""
    time: Time = UNKNOWN
    aside: bool = False


#: An upload; or the reason why the file is not one, which the instructor reads; or None if the name does not fit.
Interpretation = UploadedFile | str | None

#: For files that the platform wrote itself: left out without a message.
OWN = ""


@dataclass(frozen=True)
class Export:
    """The files of a class, by path. `root` is the name of the folder or zip that contains them.

    `zone` is the time zone of times that have none (None: this machine's).
    """

    files: Mapping[Parts, File]
    root: str
    exercise: Exercise
    zone: tzinfo | None

    def text(self, *parts: str) -> str:
        """Return the text of a file, or an empty text if there is no such file."""
        file = self.files.get(parts)
        if not file or file.path.is_symlink() or not file.path.is_file():
            return ""
        content = file.path.read_bytes()
        utf16 = content.startswith((b"\xff\xfe", b"\xfe\xff"))
        return content.decode("utf-16" if utf16 else "utf-8-sig", errors="replace")


@dataclass(frozen=True)
class ExportTable:
    """A table of grades: the file's name, and its content for some entries and the due date."""

    file: str
    content: Callable[[Exercise, Sequence[Entry], datetime | None], str]


@dataclass(frozen=True)
class Format:
    """A platform's format, or another way to organise submissions.

    `read` returns a function that interprets a path, or None if the export does not have this format. `inside` names
    the folders that contain the submissions, `next_to` what may be next to them. `of_row` returns the student in a row
    of the platform's own list of students, named as in its export, or None for another table. `dates` says where the
    dates of submissions can come from if the export has none.
    """

    name: str
    title: str
    read: Callable[[Export], Callable[[Parts], Interpretation] | None]
    inside: tuple[str, ...] = ()
    next_to: tuple[str, ...] = ()
    of_row: Callable[[Mapping[str, str]], Student | None] | None = None
    dates: str = ""
    table: ExportTable | None = None


def person(unique: str, name: str = "", email: str = "", /, **lms: str) -> Student:
    """Return a student as an export names them, with names in Unicode's form NFC. `lms` are columns of any name."""
    return Student(normal(unique), normal(name), email, lms)


def last_and_first(student: Student) -> tuple[str, str]:
    """Return last and first name: "Müller, Jörg" is split at the comma, "Jörg Müller" before the last word."""
    name = student.name.strip()
    if "," in name:
        last, _, first = name.partition(",")
    else:
        first, _, last = name.rpartition(" ")
    return last.strip(), first.strip()
