"""ILIAS: a folder `Last_First_login_NUMBER` per student, in a folder `Team NUMBER` for teams.

Source: ILIAS, Modules/Exercise/classes/class.ilExSubmission.php, downloadAllAssignmentFiles and
getDirectoryNameFromUserData. A late file is called `Late Submission - FILE`. Files of a single student begin with
the time, 20261120220100_FILE, in the server's zone.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from datetime import datetime

from grader.classroom.formats.format import OWN, Export, Format, Interpretation, Parts, UploadedFile, person
from grader.classroom.times import Time, localized

FOLDER = re.compile(r"(?P<last>[^_]+)_(?P<first>.+)_(?P<login>[^_]+)_(?P<number>\d+)")
TEAM = re.compile(r"[^\W\d]+ \d+")
FILE = re.compile(
    r"(?:(?P<late>Late Submission|Verspätete Abgabe|Verspaetete Abgabe) - )?(?:(?P<time>\d{14})_)?(?P<name>.+)"
)
SOURCE = "ILIAS"


def read(export: Export) -> Callable[[Parts], Interpretation] | None:
    """Return how to read ILIAS's folder names. Each student has a number of their own."""
    folders = {_own(parts)[0] for parts in export.files if _own(parts)}
    numbers = [match["number"] for folder in folders if (match := FOLDER.fullmatch(folder))]
    if not numbers or len(set(numbers)) < len(numbers):
        return None

    def understand(parts: Parts) -> Interpretation:
        own = _own(parts)
        match = FOLDER.fullmatch(own[0]) if len(own) > 1 else None
        if not match:
            return OWN if len(parts) == 1 and parts[0].endswith((".xlsx", ".xls")) else None
        file = FILE.fullmatch(own[1])
        assert file
        name = f"{match['last']}, {match['first'].replace('_', ' ')}"
        team = own[0] != parts[0]
        student = person(own[0], name, Login=match["login"], **({"Group": parts[0]} if team else {}))
        time = Time(_time(file["time"], export), SOURCE, late=True if file["late"] else None)
        return UploadedFile((student,), (file["name"], *own[2:]), file["time"] or "", time)

    return understand


def _own(parts: Parts) -> Parts:
    return parts[1:] if TEAM.fullmatch(parts[0]) else parts


def _time(digits: str | None, export: Export) -> datetime | None:
    try:
        return localized(datetime.strptime(digits or "", "%Y%m%d%H%M%S"), export.zone)
    except ValueError:
        return None


FORMAT = Format(
    "ilias",
    "a download from ILIAS",
    read,
    inside=("Submissions", "submissions", "Abgaben", "Einreichungen"),
    dates="ILIAS's download of a class has no dates.",
)
