"""Blackboard's "Download assignment submissions": ASSIGNMENT_USER_attempt_TIME_FILE in one folder, each with a .txt.

Source: Blackboard's help, "Download assignments". The time has no zone: it is the institution's. In other languages,
"attempt" and "Name" in the .txt are other words.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from grader.classroom.formats.format import Export, Format, Interpretation, Parts, UploadedFile, person
from grader.classroom.times import read_time
from grader.grading.grade import Student

NAME = re.compile(
    r"(?P<before>.+?)_[^\W\d_]+_(?P<day>\d{4}-\d\d-\d\d)-(?P<h>\d\d)-(?P<m>\d\d)-(?P<s>\d\d)(?:_(?P<file>.+)|(?P<own>\.txt))"
)
WHO = re.compile(r"\A[^:\n]+: (?P<name>.*?) \((?P<user>[^()]*)\)\s*$", re.MULTILINE)
SOURCE = "Blackboard"


def read(export: Export) -> Callable[[Parts], Interpretation]:
    """Return how to read Blackboard's names. The part before the user's name is the assignment's, the same in all."""
    before = [match["before"] for parts in export.files if (match := NAME.fullmatch(parts[-1]))]
    texts = {match["before"]: export.text(*parts) for parts in export.files if (match := _own(parts))}
    common = _assignment(before)

    def understand(parts: Parts) -> Interpretation:
        match = NAME.fullmatch(parts[-1])
        if not match or len(parts) > 1:
            return None
        who = WHO.search(texts.get(match["before"], ""))
        user = match["before"].removeprefix(common)
        if who and match["before"].endswith(f"_{who['user']}"):
            user = who["user"]
        attempt = f"{match['day']} {match['h']}{match['m']}{match['s']}"
        time = read_time(attempt, SOURCE, export.zone)
        student = person(user, who["name"] if who else "", Username=user)
        inside = (match["file"] or parts[-1],)
        return UploadedFile((student,), inside, attempt, time, aside=bool(match["own"]))

    return understand


def _own(parts: Parts) -> re.Match[str] | None:
    match = NAME.fullmatch(parts[-1])
    return match if match and match["own"] else None


def _assignment(before: list[str]) -> str:
    """Return the beginning that all names share, up to an underscore. The assignment's name may contain underscores."""
    split = [name.split("_") for name in before]
    if not split:
        return ""
    most = min(len(words) for words in split) - 1
    if len({tuple(words) for words in split}) == 1:  # one student: the assignment's name is all but the last word
        return "".join(f"{word}_" for word in split[0][:-1])
    same = 0
    while same < most and len({words[same] for words in split}) == 1:
        same += 1
    return "".join(f"{word}_" for word in split[0][:same])


def of_row(row: Mapping[str, str]) -> Student | None:
    """Return the student in a row of Blackboard's grade center."""
    if not {"Username", "Last Name", "First Name"} <= row.keys() or "OrgDefinedId" in row:
        return None
    name = f"{row['First Name']} {row['Last Name']}".strip()
    return person(row["Username"], name, row.get("Email", ""), **row)


FORMAT = Format("blackboard", "a download from Blackboard", read, of_row=of_row)
