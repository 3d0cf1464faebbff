"""Sakai: a folder `Last, First(login)` per student, with timestamp.txt and the attachments in a folder.

Source: sakai, AssignmentServiceImpl.java, zipSubmissions and zipGroupSubmissions. A group's folder has members.txt,
"Last, First(login); Last, First(login)". Names of folders depend on the language; names of Sakai's own files do not.
Downloaded without folders, a file is `Last, First(login)_Submission attachment(s)_FILE`, and only grades.csv has times.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator, Mapping
from datetime import timezone

from grader.classroom.formats.format import OWN, Export, Format, Interpretation, Parts, UploadedFile, person
from grader.classroom.names import normal
from grader.classroom.times import UNKNOWN, Time, read_time
from grader.grading.grade import Student

FOLDER = re.compile(r"(?P<name>[^()]*,[^()]*)\((?P<login>[^()]+)\)")
FLAT = re.compile(r"(?P<owner>[^()]*,[^()]*\([^()]+\))_(?P<label>[^_]*)_(?P<file>.+)")
MEMBER = re.compile(r"\s*(?P<name>[^()]*,[^()]*)\((?P<login>[^()]+)\)\s*")
TIMESTAMP, MEMBERS = "timestamp.txt", "members.txt"
SAKAIS = {"comments.txt", "feedbackText.html", MEMBERS}
OF_ALL = re.compile(r"grades\.(csv|xls|xlsx)|.*\.html")


def read(export: Export) -> Callable[[Parts], Interpretation] | None:
    """Return how to read folders with names of Sakai's form, or with a list of members."""
    folders = {parts[0] for parts in map(_with_folders, export.files) if len(parts) > 1}
    if not any(FOLDER.fullmatch(folder) or export.text(folder, MEMBERS) for folder in folders):
        return None
    students = {folder: _students(export, folder) for folder in folders}
    handed_in = {parts[0] for parts in map(_with_folders, export.files) if len(parts) > 1 and not _is_sakais(parts)}
    listed = dict(_listed_times(export))
    times = {
        folder: read_time(export.text(folder, TIMESTAMP), TIMESTAMP, timezone.utc)
        if (folder, TIMESTAMP) in export.files
        else next((listed[student.id] for student in students[folder] if student.id in listed), UNKNOWN)
        for folder in folders
    }

    def understand(path: Parts) -> Interpretation:
        parts = _with_folders(path)
        if len(parts) == 1:
            return OWN if OF_ALL.fullmatch(parts[0]) else None
        if not students[parts[0]]:
            return None
        if _is_sakais(parts):
            return OWN if parts[0] in handed_in else "nothing but Sakai's own files: no submission"
        aside = len(parts) == 2 and (parts[1] == TIMESTAMP or parts[1].endswith("_submissionText.html"))
        return UploadedFile(students[parts[0]], parts[2:] or parts[1:], time=times[parts[0]], aside=aside)

    return understand


def _is_sakais(parts: Parts) -> bool:
    return parts[1] in SAKAIS or parts[1].startswith("Feedback Attachment")


def _with_folders(parts: Parts) -> Parts:
    """Return the path as in a download with folders."""
    if len(parts) == 1 and (match := FLAT.fullmatch(parts[0])):
        inside = (match["label"], match["file"]) if match["label"] else (f"_{match['file']}",)
        return (match["owner"], *inside)
    own = re.fullmatch(rf"(.*\([^()]+\))_({'|'.join(map(re.escape, SAKAIS))}|Feedback Attachment.*)", parts[0])
    return (own[1], own[2]) if own and len(parts) == 1 else parts


def _listed_times(export: Export) -> Iterator[tuple[str, Time]]:
    """Yield the login and the time of each student in grades.csv, whose columns are the second and the sixth."""
    text = export.text("grades.csv")
    for row in csv.reader(io.StringIO(text), delimiter=";" if text.count(";") > text.count(",") else ","):
        if len(row) > 5 and (time := read_time(row[5], "grades.csv", timezone.utc)).at:
            yield normal(row[1]), time


def _students(export: Export, folder: str) -> tuple[Student, ...]:
    members = export.text(folder, MEMBERS).split(";")
    listed = [match for member in members if (match := MEMBER.fullmatch(member))]
    if not listed and (match := FOLDER.fullmatch(folder)):
        listed = [match]
    return tuple(person(match["login"], match["name"].strip(" ,"), EID=match["login"]) for match in listed)


def of_row(row: Mapping[str, str]) -> Student | None:
    """Return the student in a row of Sakai's grades.csv."""
    if not {"Display ID", "ID", "Last Name", "First Name"} <= row.keys():
        return None
    name = f"{row['Last Name']}, {row['First Name']}"
    return person(row["ID"] or row["Display ID"], name, **row)


FORMAT = Format(
    "sakai",
    "a download from Sakai",
    read,
    of_row=of_row,
    dates=f"Each folder may have a {TIMESTAMP}, and grades.csv the times of all.",
)
