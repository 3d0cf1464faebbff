"""Who submitted what, in the downloads of Canvas and Moodle and in nbgrader's folders."""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import datetime, timezone

from grader.classroom import Skipped, Student
from grader.classroom.handed_in import File, Sorted, student_id

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
