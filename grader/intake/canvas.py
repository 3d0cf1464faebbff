"""Canvas's "Download Submissions": lastnamefirst_12345_678901_node-2.py, with _LATE_ after the name where it was late.

The first number is the student's, the second the upload's; `-2` tells a second hand-in from the first. Canvas leaves
out what was replaced. Source: Canvas Instructor Guide, "How do I download all student submissions for an assignment?".
"""

from __future__ import annotations

import re

from grader.classroom import Skipped, Student
from grader.intake.handed_in import File, Sorted, student_id

NAME = re.compile(r"(?P<name>[^_/]+)(?P<late>_LATE)?_(?P<user>\d+)_(?P<upload>\d+)_(?P<file>.+)")


def by_user(files: list[File]) -> Sorted | None:
    """Files by Canvas's users, or None where the files' names are not mostly such as Canvas gives."""
    graded = [file for file in files if file.can_be_graded]
    if 2 * sum(bool(NAME.fullmatch(file.parts[-1])) for file in graded) <= len(graded):
        return None
    found, skipped = [], []
    for file in files:
        match = NAME.fullmatch(file.parts[-1])
        if match:
            student = Student(student_id(f"{match['name']}_{match['user']}"), match["name"], "", {"ID": match["user"]})
            found.append((student, file))
        else:
            skipped.append(Skipped(file.name, "its name is none that Canvas gives"))
    return Sorted("a download from Canvas", tuple(found), tuple(skipped))
