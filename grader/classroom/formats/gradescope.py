"""Gradescope's "Export submissions": submission_NUMBER/, and who submitted them in submission_metadata.yml.

Source: Gradescope's guide, "Exporting submissions"; its file has `:submitters:` with `:name:`, `:sid:` and `:email:`,
and `:created_at:`, per folder.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from datetime import timezone
from typing import Any

import yaml

from grader.classroom.formats.format import OWN, Export, Format, Interpretation, Parts, UploadedFile, person
from grader.classroom.times import read_time
from grader.grading.grade import Student

METADATA = "submission_metadata.yml"
FOLDER = re.compile(r"submission_\d+")


def read(export: Export) -> Callable[[Parts], Interpretation] | None:
    """Return how to read the folders that the export's own list names."""
    try:
        listed = yaml.load(export.text(METADATA), Loader=yaml.BaseLoader)
    except yaml.YAMLError:
        return None
    if not isinstance(listed, dict) or not any(FOLDER.fullmatch(str(name)) for name in listed):
        return None
    uploads = {name: _upload(one) for name, one in listed.items() if isinstance(one, dict)}
    absent = uploads.keys() - {parts[0] for parts in export.files}

    def understand(parts: Parts) -> Interpretation:
        if parts == (METADATA,):
            return f"it names folders that are not there: {', '.join(sorted(absent))}" if absent else OWN
        upload = uploads.get(parts[0]) if len(parts) > 1 else None
        return UploadedFile(upload.students, parts[1:], upload.attempt, upload.time) if upload else None

    return understand


def _upload(one: dict[str, Any]) -> UploadedFile | None:
    students = tuple(_student(who) for who in one.get(":submitters") or [] if isinstance(who, dict))
    created = str(one.get(":created_at", ""))
    time = read_time(created, METADATA, timezone.utc)
    return UploadedFile(students, (), time.at.isoformat() if time.at else created, time) if students else None


def _student(who: dict[str, Any]) -> Student:
    name, sid, email = (str(who.get(f":{key}") or "") for key in ("name", "sid", "email"))
    return person(_id(name, sid, email), name, email, **({"SID": sid} if sid else {}))


def _id(name: str, sid: str, email: str) -> str:
    return "_".join(filter(None, (name, sid or email)))


def of_row(row: Mapping[str, str]) -> Student | None:
    """Return the student in a row of Gradescope's roster or grades."""
    if "SID" not in row or not {"First Name", "Last Name"} <= row.keys():
        return None
    name = f"{row['First Name']} {row['Last Name']}".strip()
    email = row.get("Email", "")
    return person(_id(name, row["SID"], email), name, email, **row)


FORMAT = Format("gradescope", "an export from Gradescope", read, of_row=of_row)
