"""Moodle's "Download all submissions", with folders or without.

Full Name_1234567_assignsubmission_file_/node.py, or Full Name_1234567_assignsubmission_file_node.py. Source:
mod/assign/locallib.php of Moodle, download_submissions.
"""

from __future__ import annotations

import re

from grader.classroom import Skipped, Student
from grader.intake.handed_in import File, Sorted, student_id

NAME = re.compile(r"(?P<name>.+?)_(?P<number>\d+)_assignsubmission_(?P<kind>[a-z]+)(?:_|$)")


def by_participant(files: list[File]) -> Sorted | None:
    """Files by Moodle's participants, or None where no file has a name that Moodle gives."""
    found: list[tuple[Student, File]] = []
    skipped = []
    for file in files:
        match = next(filter(None, (NAME.match(part) for part in file.parts)), None)
        if not match:
            skipped.append(Skipped(file.name, "its name is none that Moodle gives"))
        elif match["kind"] != "file":
            skipped.append(Skipped(file.name, "a text written in Moodle, not a file"))
        else:
            # As Moodle's grading worksheet calls them.
            lms = {"Identifier": f"Participant {match['number']}", "Full name": match["name"]}
            found.append((Student(student_id(f"{match['name']}_{match['number']}"), match["name"], "", lms), file))
    return Sorted("a download from Moodle", tuple(found), tuple(skipped)) if found else None
