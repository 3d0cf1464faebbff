"""Brightspace (D2L): a folder `USER-FOLDER - NAME - TIME` per submission, and index.html.

Without folders, a file is `USER-FOLDER - NAME - TIME - FILE`. A group's name may have no numbers before it.

Source: Brightspace's help, "Download submissions". The time, such as "Nov 20, 2026 1001 PM", has no zone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from grader.classroom.formats.format import OWN, Export, Format, Interpretation, Parts, UploadedFile, person
from grader.classroom.times import read_time
from grader.grading.grade import Student

NAME = re.compile(
    r"(?:(?P<user>\d+)-\d+ ?- ?)?(?P<name>.+?) ?- ?(?P<time>[^-]*\d{4},? \d{3,4}(?: ?[AP]M)?)(?: ?- ?(?P<file>.+))?",
    re.I,
)
SOURCE = "Brightspace"


def read(export: Export) -> Callable[[Parts], Interpretation]:
    """Return how to read the names that Brightspace gives to folders."""

    def understand(parts: Parts) -> Interpretation:
        if parts == ("index.html",):
            return OWN
        match = NAME.fullmatch(parts[0])
        inside = parts[1:] or (match and match["file"] and (match["file"],))
        if not match or not inside:
            return None
        time = read_time(match["time"].strip(), SOURCE, export.zone)
        user = {"UserID": match["user"]} if match["user"] else {}
        student = person("_".join((match["name"], *user.values())), match["name"], **user)
        return UploadedFile((student,), inside, time.at.isoformat() if time.at else match["time"], time)

    return understand


def of_row(row: Mapping[str, str]) -> Student | None:
    """Return the student in a row of Brightspace's grades; its export of submissions uses a different number."""
    if not {"OrgDefinedId", "Username"} <= row.keys():
        return None
    name = f"{row.get('First Name', '')} {row.get('Last Name', '')}".strip()
    return person(row["Username"].lstrip("#"), name, row.get("Email", ""), **row)


FORMAT = Format("brightspace", "a download from Brightspace", read, of_row=of_row)
