"""Finds out who submitted what: in a folder, a zip, a learning platform's download, or by a CSV file."""

from __future__ import annotations

import os
import re
import stat
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path, PurePosixPath

from grader.classroom.handed_in import (
    SUFFIXES,
    File,
    HandedIn,
    Question,
    Sorted,
    Submissions,
    SubmissionsError,
    moment,
    student_id,
    table_rows,
)
from grader.grading.grade import Skipped, Student
from grader.submission.reading import MOST_BYTES

# The first number is the student's, the second the upload's; `-2` marks a second submission. Canvas leaves out what
# was replaced. Source: Canvas Instructor Guide, "How do I download all student submissions for an
# assignment?".


CANVAS_NAME = re.compile(r"(?P<name>[^_/]+)(?P<late>_LATE)?_(?P<user>\d+)_(?P<upload>\d+)_(?P<file>.+)")


def by_user(files: list[File]) -> Sorted | None:
    """Return the files by Canvas's users, or None unless most of the files have names as Canvas gives them."""
    graded = [file for file in files if file.can_be_graded]
    if 2 * sum(bool(CANVAS_NAME.fullmatch(file.parts[-1])) for file in graded) <= len(graded):
        return None
    found, skipped = [], []
    for file in files:
        match = CANVAS_NAME.fullmatch(file.parts[-1])
        if match:
            student = Student(student_id(f"{match['name']}_{match['user']}"), match["name"], "", {"ID": match["user"]})
            found.append((student, file))
        else:
            skipped.append(Skipped(file.name, "its name is none that Canvas gives"))
    return Sorted("a download from Canvas", tuple(found), tuple(skipped))


# Full Name_1234567_assignsubmission_file_/node.py, or Full Name_1234567_assignsubmission_file_node.py. Source:
# mod/assign/locallib.php of Moodle, download_submissions.


MOODLE_NAME = re.compile(r"(?P<name>.+?)_(?P<number>\d+)_assignsubmission_(?P<kind>[a-z]+)(?:_|$)")


def by_participant(files: list[File]) -> Sorted | None:
    """Return the files by Moodle's participants, or None if no file has a name that Moodle gives."""
    found: list[tuple[Student, File]] = []
    skipped = []
    for file in files:
        match = next(filter(None, (MOODLE_NAME.match(part) for part in file.parts)), None)
        if not match:
            skipped.append(Skipped(file.name, "its name is none that Moodle gives"))
        elif match["kind"] != "file":
            skipped.append(Skipped(file.name, "a text written in Moodle, not a file"))
        else:
            # The names in Moodle's grading worksheet.
            lms = {"Identifier": f"Participant {match['number']}", "Full name": match["name"]}
            found.append((Student(student_id(f"{match['name']}_{match['number']}"), match["name"], "", lms), file))
    return Sorted("a download from Moodle", tuple(found), tuple(skipped)) if found else None


# Source of the layout: nbgrader's documentation, "The philosophy and the approach" and "Collecting submissions".


TIMESTAMP = "timestamp.txt"
WRITTEN = re.compile(r"(\d{4}-\d\d-\d\d[ T]\d\d:\d\d:\d\d)(?:\.\d+)?\s*(.*)")


def by_assignment(files: list[File], root: str, exercise: str) -> Sorted | None:
    """Return the files of one assignment, or None if these are not nbgrader's folders.

    `root` is the name of the given folder: it may be `submitted` itself, or its parent.
    """
    if any(file.parts[0] == "submitted" for file in files):
        inside = [(file, file.parts[1:]) for file in files if file.parts[0] == "submitted"]
    else:
        inside = [(file, file.parts) for file in files]
        named = any(len(parts) > 2 and parts[1] == exercise for _, parts in inside)
        if root != "submitted" and not named:
            return None
    assignments = {parts[1] for _, parts in inside if len(parts) > 2}
    if not assignments:
        return None
    # A course may use any name for the assignment, as long as there is only one.
    wanted = next(iter(assignments)) if len(assignments) == 1 else exercise
    dates = {parts[0]: _date(file) for file, parts in inside if parts[1:] == (wanted, TIMESTAMP)}
    found, skipped = [], [Skipped(f"*/{name}", "another assignment") for name in sorted(assignments - {wanted})]
    for file, parts in inside:
        if len(parts) < 3:
            skipped.append(Skipped(file.name, "it is not in a STUDENT/ASSIGNMENT folder"))
        elif parts[1] == wanted and parts[2:] != (TIMESTAMP,):
            date = dates.get(parts[0])
            dated = replace(file, submitted=date, submitted_from=TIMESTAMP) if date else file
            name = parts[0] if parts[0] != student_id(parts[0]) else ""
            found.append((Student(student_id(parts[0]), name), dated))
    return Sorted("nbgrader's folder of submissions", tuple(found), tuple(skipped))


def _date(file: File) -> datetime | None:
    """Return the time in a timestamp.txt, which ends with a time zone's name; None if the zone is unknown."""
    try:
        match = WRITTEN.match(file.path.read_text(encoding="utf-8", errors="replace")[:200])
        if not match:
            return None
        written = datetime.fromisoformat(match[1])
        return written.replace(tzinfo=_zone(match[2].strip()))
    except (OSError, ValueError):
        return None


def _zone(name: str):  # type: ignore[no-untyped-def]  # noqa: ANN202 - tzinfo, of two kinds
    from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

    if name in ("", "UTC", "GMT"):
        return timezone.utc
    try:
        return ZoneInfo(name)
    except ZoneInfoNotFoundError:
        raise ValueError(name) from None


#: Made by operating systems, editors and Python, never by a student.
NOISE = {"__MACOSX", "__pycache__", "Thumbs.db", "desktop.ini"}
WHY_NOISE = "made by a program, not handed in"


def is_noise(name: str) -> bool:
    """Return whether a file or folder of this name can be ignored."""
    return name in NOISE or name.startswith(".")


def walk(root: Path) -> Iterator[File | Skipped]:
    """Yield every file below `root`, sorted by name; symbolic links are not followed."""
    for folder, folders, names in os.walk(root):
        inside = Path(folder).relative_to(root)
        for name in sorted([*folders, *names]):
            if is_noise(name):
                yield Skipped((inside / name).as_posix(), WHY_NOISE)
        folders[:] = sorted(name for name in folders if not is_noise(name))
        for name in sorted(names):
            if not is_noise(name):
                path = Path(folder, name)
                yield File((inside / name).as_posix(), path, date_of(path), "the file's date")


def date_of(path: Path) -> datetime | None:
    """Return the file's date, if any; an archive can give a file a date that does not exist."""
    try:
        return datetime.fromtimestamp(path.lstat().st_mtime, timezone.utc)
    except (OSError, ValueError, OverflowError):
        return None


def by_student(files: list[File]) -> Sorted:
    """Sort files named STUDENT.py, or in one folder per student, by student."""
    found = []
    for file in files:
        top = file.parts[0]
        name = top if len(file.parts) > 1 else top.rpartition(".")[0] or top
        found.append((Student(student_id(name), name if name != student_id(name) else ""), file))
    return Sorted("a folder with one file (or one folder) per student", tuple(found))


NEEDED = ("file", "student")
KNOWN = (*NEEDED, "name", "email", "submitted")


def by_row(table: Path) -> Sorted:
    """Return the files in the rows, relative to the CSV file's folder. Raises `SubmissionsError` for a row with a
    mistake.

    Other columns are kept for each student, as their learning platform's.
    """
    found, skipped = [], []
    for number, row in table_rows(table, NEEDED):
        if not row["student"] or not row["file"]:
            raise SubmissionsError(
                f"{table}:{number}: file = {row['file']!r}, student = {row['student']!r}. Give both."
            )
        path = table.parent / row["file"]
        if not path.is_file() and not path.is_symlink():
            skipped.append(Skipped(row["file"], f"line {number} names it, but there is no such file"))
            continue
        if row.get("submitted"):
            date, date_source = moment(row["submitted"]), "the CSV file"
            if date is None:
                given = row["submitted"]
                raise SubmissionsError(f"{table}:{number}: submitted = {given!r}. Write it as 2026-11-22 23:59.")
        else:
            date, date_source = date_of(path), "the file's date"
        lms = {column: value for column, value in row.items() if column not in KNOWN}
        student = Student(student_id(row["student"]), row.get("name", ""), row.get("email", ""), lms)
        found.append((student, File(row["file"], path, date, date_source)))
    return Sorted(f"the files that {table.name} names", tuple(found), tuple(skipped))


#: A thousand students with as many files as they like.
MOST_FILES = 20_000
MOST_BYTES_IN_ALL = 2_000_000_000

#: A little more than a submission may have: reading it says what is wrong with a larger one.
MOST_BYTES_OF_ONE = max(MOST_BYTES.values()) + 1

BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError, OSError, ValueError)


def unpacked(archive: Path, into: Path) -> Iterator[File | Skipped]:
    """Yield the files in `archive` that can be submissions, written into the folder `into` with numbers as names.

    Raises `SubmissionsError` when it is not a zip, or holds more than any class submits.
    """
    try:
        opened = zipfile.ZipFile(archive)
    except BROKEN as error:
        raise SubmissionsError(f"{archive}: it is not a valid zip file: {error}. Was the download cut off?") from None
    with opened:
        entries = [entry for entry in opened.infolist() if not entry.is_dir()]
        if len(entries) > MOST_FILES:
            raise SubmissionsError(f"{archive}: it holds {len(entries):,} files, more than {MOST_FILES:,}.")
        left = MOST_BYTES_IN_ALL
        for number, entry in enumerate(sorted(entries, key=lambda entry: entry.filename)):
            name = _name(entry)
            why = _why_not(entry, name)
            if why:
                yield Skipped(name, why)
                continue
            path = into / f"{number:05}{PurePosixPath(name).suffix}"
            try:
                with opened.open(entry) as packed:
                    content = packed.read(min(MOST_BYTES_OF_ONE, left + 1))
            except BROKEN as error:
                yield Skipped(name, f"it can't be read: {error}")
                continue
            left -= len(content)
            if left < 0:
                raise SubmissionsError(f"{archive}: unpacked, it is larger than {MOST_BYTES_IN_ALL // 10**9} GB.")
            path.write_bytes(content)
            yield File(name, path, _entry_date(entry), "the zip file")


def _name(entry: zipfile.ZipInfo) -> str:
    parts = PurePosixPath(entry.filename.replace("\\", "/")).parts
    return "/".join(part for part in parts if part not in ("/", "..")) or "nameless"


def _why_not(entry: zipfile.ZipInfo, name: str) -> str:
    """Return why an entry is left out, or an empty text."""
    if any(is_noise(part) for part in name.split("/")):
        return WHY_NOISE
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "a symbolic link, not a file"
    if entry.flag_bits & 1:
        return "it is encrypted"
    # nbgrader's time stamps are not submissions, but they say when one was submitted.
    return "" if name.endswith((*SUFFIXES, "/timestamp.txt")) else f"not one of {', '.join(SUFFIXES)}"


def _entry_date(entry: zipfile.ZipInfo) -> datetime | None:
    """Return an entry's date. A zip has the local time of its creator, without a zone: taken as this machine's."""
    try:
        return datetime(*entry.date_time).astimezone()
    except (ValueError, OverflowError, OSError):
        return None


def collect(source: Path, exercise: str, unpack_into: Path) -> Submissions:
    """Return what the class submitted, from a folder, a zip or a CSV file; the file names decide how to read it.

    A zip's files are written into the folder `unpack_into`, which has to be empty. Raises `SubmissionsError` when
    there is nothing at all to grade.
    """
    if not source.exists():
        raise SubmissionsError(f"{source}: there is no such file or folder.")
    if source.suffix == ".csv":
        return _chosen(by_row(source), ())
    found = list(walk(source) if source.is_dir() else unpacked(source, unpack_into))
    files = [file for file in found if isinstance(file, File)]
    left_out = tuple(skipped for skipped in found if isinstance(skipped, Skipped))
    root = source.resolve().name.removesuffix(".zip")
    return _chosen(
        by_participant(files) or by_assignment(files, root, exercise) or by_user(files) or by_student(files), left_out
    )


def _chosen(files: Sorted, left_out: tuple[Skipped, ...]) -> Submissions:
    """Choose one file per student; several files become a question, never a guess."""
    skipped = [*left_out, *files.skipped]
    candidates: dict[str, tuple[Student, list[File]]] = {}
    for student, file in files.files:
        if file.can_be_graded:
            candidates.setdefault(student.id, (student, []))[1].append(file)
        else:
            skipped.append(Skipped(file.name, f"not one of {', '.join(SUFFIXES)}"))
    handed_in, questions = [], []
    for _, (student, theirs) in sorted(candidates.items()):
        if len(theirs) == 1:
            handed_in.append(HandedIn(student, theirs[0]))
        else:
            questions.append(Question(student, tuple(file.name for file in theirs)))
    if not candidates:
        kinds = ", ".join(SUFFIXES)
        text = "".join(f"\n  {skip.file}: {skip.why}" for skip in skipped[:10])
        raise SubmissionsError(f"There is no submission in it: no file that ends with one of {kinds}.{text}")
    return Submissions(files.kind, tuple(handed_in), tuple(sorted(skipped, key=lambda s: s.file)), tuple(questions))
