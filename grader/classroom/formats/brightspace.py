"""Brightspace (D2L): a folder `USER-FOLDER - NAME - TIME` per submission, and index.html.

Source: Brightspace's help, "Download submissions". The time, such as "Nov 20, 2026 1001 PM", has no zone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from datetime import datetime

from grader.classroom.formats.format import OWN, Export, Format, Interpretation, Parts, UploadedFile, person
from grader.classroom.times import Time, localized, month_named, without_zone
from grader.grading.grade import Student

NAME = re.compile(
    r"(?P<user>\d+)-(?P<folder>\d+) ?- ?(?P<name>.+?) ?- ?(?P<time>[^-]*\d{4},? \d{3,4}(?: ?[AP]M)?)", re.I
)
TIME = re.compile(
    r"(?:(?P<month>[A-Za-z]{3,9})\.? (?P<day>\d\d?)|(?P<day2>\d\d?) (?P<month2>[A-Za-z]{3,9})),? "
    r"(?P<year>\d{4}),? (?P<hour>\d\d?)(?P<minute>\d\d)(?: ?(?P<half>[AP]M))?",
    re.IGNORECASE,
)
SOURCE = "Brightspace"


def read(export: Export) -> Callable[[Parts], Interpretation]:
    """Return how to read the names that Brightspace gives to folders."""

    def understand(parts: Parts) -> Interpretation:
        if parts == ("index.html",):
            return OWN
        match = NAME.fullmatch(parts[0])
        if not match or len(parts) < 2:
            return None
        time = _time(match["time"], export)
        student = person(f"{match['name']}_{match['user']}", match["name"], UserID=match["user"])
        return UploadedFile((student,), parts[1:], time.at.isoformat() if time.at else match["time"], time)

    return understand


def _time(text: str, export: Export) -> Time:
    match = TIME.fullmatch(text.strip())
    try:
        if not match:
            raise ValueError
        month = month_named(match["month"] or match["month2"])
        hour = int(match["hour"])
        if match["half"] and hour <= 12:  # some sites write 1301 PM
            hour = hour % 12 + 12 * (match["half"].upper() == "PM")
        day = int(match["day"] or match["day2"])
        written = datetime(int(match["year"]), month, day, hour, int(match["minute"]))
    except ValueError:
        return Time(source=SOURCE, fault=f"{SOURCE} says {text!r}, which is not a time that can be read")
    return Time(localized(written, export.zone), SOURCE, note=without_zone(export.zone))


def of_row(row: Mapping[str, str]) -> Student | None:
    """Return the student in a row of Brightspace's grades; its export of submissions uses a different number."""
    if not {"OrgDefinedId", "Username"} <= row.keys():
        return None
    name = f"{row.get('First Name', '')} {row.get('Last Name', '')}".strip()
    return Student(person(row["Username"].lstrip("#")).id, person("", name).name, row.get("Email", ""), dict(row))


FORMAT = Format("brightspace", "a download from Brightspace", read, of_row=of_row)
