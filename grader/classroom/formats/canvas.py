"""Canvas: NAME[_LATE]_USER_UPLOAD_FILE in one folder, and its gradebook.

Source of the names: canvas-lms, lib/content_zipper.rb: the name in lower case without spaces, or the group's;
`LATE`; the user's number, or `anon_` and a key in anonymous grading; the upload's number. A file with a name that the
user has used before gets `-1`, `-2`, as in Attachment.make_unique_filename. The zip's entries have the date of the
download.
Source of the table: canvas-lms, lib/gradebook_exporter.rb and gradebook_importer.rb.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime

from grader.classroom.formats.format import (
    Export,
    ExportTable,
    Format,
    Interpretation,
    Parts,
    UploadedFile,
    last_and_first,
    person,
)
from grader.classroom.tables import Cell, csv_text
from grader.classroom.times import Time
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry, Student

NAME = re.compile(
    r"(?:(?P<anonymous_late>LATE_)?(?P<anonymous>anon_[A-Za-z0-9]+)|(?P<name>.*?)(?P<late>_LATE)?_(?P<user>\d+))_"
    r"(?:(?P<upload>\d+)_(?P<file>.+)|(?P<page>text|link)\.html)",
    re.DOTALL,
)
AGAIN = re.compile(r"(?P<stem>.+)-(?P<number>\d{1,3})(?P<suffix>(?:\.[^.]+)*)")


def read(export: Export) -> Callable[[Parts], Interpretation]:
    """Return how to read Canvas's names."""
    first: dict[str, set[str]] = defaultdict(set)
    for parts in export.files:
        if match := NAME.fullmatch(parts[-1]):
            first[_user(match)].add(match["file"] or "")

    def understand(parts: Parts) -> Interpretation:
        match = NAME.fullmatch(parts[-1])
        if not match or len(parts) > 1:
            return None
        name, user = match["name"] or "", _user(match)
        student = person("_".join(filter(None, (name, user))), name, ID=user)
        time = Time(source="Canvas", late=bool(match["late"] or match["anonymous_late"]))
        if match["page"]:
            return UploadedFile((student,), parts, time=time, aside=True)
        attempt, file = _attempt(match["file"], first[user])
        return UploadedFile((student,), (file,), attempt, time)

    return understand


def _user(match: re.Match[str]) -> str:
    return str(match["user"] or match["anonymous"])


def _attempt(file: str, others: set[str]) -> tuple[str, str]:
    """Return a file's attempt and name. `-1` counts as an attempt only if there is another file of the same name."""
    number, stem = _numbered(file)
    same = [other for other in others if stem in (other, _numbered(other)[1])]
    return (number, stem) if len(same) > 1 else ("", file)


def _numbered(file: str) -> tuple[str, str]:
    """Return the number that Canvas added to a file's name, and the name without it."""
    again = AGAIN.fullmatch(file)
    return (f"{int(again['number']):03}", f"{again['stem']}{again['suffix']}") if again else ("000", file)


def of_row(row: Mapping[str, str]) -> Student | None:
    """Return the student in a row of Canvas's gradebook: "Müller, Jörg" with ID 12 is müllerjörg_12 in names."""
    if not {"Student", "ID"} <= row.keys() or not row["ID"].isdigit():
        return None
    name = re.sub(r"[^\w]", "", row["Student"].lower())
    return person(f"{name}_{row['ID']}", row["Student"], **row)


def table(exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None) -> str:
    """Return the table in the format that Canvas exports and imports.

    Canvas finds students by ID, otherwise by SIS User ID, SIS Login ID or name, which come from `Student.lms`. The
    assignment's column is the one in `lms` that is called like an assignment, "Name (1234)". If there is none, it is
    the exercise's title, from which Canvas creates a new assignment. Without a score the cell is empty, and Canvas
    leaves the grade as it is.
    """
    known = [name for entry in entries for name in entry.student.lms]
    assignment = next((name for name in known if re.fullmatch(r".+ \(\d+\)", name)), exercise.title)
    identity = ["ID", *(["SIS User ID"] if "SIS User ID" in known else []), "SIS Login ID", "Section"]
    points = entries[0].grade.points if entries else exercise.points
    rows: list[list[Cell]] = [["    Points Possible", *[None] * len(identity), points]]
    for entry in entries:
        lms = entry.student.lms
        login = lms.get("SIS Login ID", "" if "ID" in lms else entry.student.id)
        cells = {**lms, "SIS Login ID": login}
        # Canvas sorts by "Müller, Jörg".
        name = lms.get("Student") or ", ".join(filter(None, last_and_first(entry.student))) or entry.student.id
        rows.append([name, *(cells.get(column, "") for column in identity), entry.final])
    return csv_text(["Student", *identity, assignment], rows)


FORMAT = Format(
    "canvas",
    "a download from Canvas",
    read,
    of_row=of_row,
    dates="Canvas writes no dates, only LATE.",
    table=ExportTable("canvas.csv", table),
)
