"""One zip per student, to hand out: the feedback page, without anything about other students or hidden checks."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from grader.grading.grade import Entry
from grader.report.as_json import folder_of
from interface_compiler.wheel_file import zipped

FOLDER = "to-students"


def publish(results: Path, entries: Sequence[Entry]) -> Path:
    """Write a read-only `to-students/STUDENT.zip` per entry, and return the folder. Other zips are removed."""
    folder = results / FOLDER
    folder.mkdir(exist_ok=True)
    zips = {}
    for entry in entries:
        page, file = f"{entry.grade.exercise}/feedback.html", folder_of(results, entry.student.id) / "feedback.html"
        zips[f"{entry.student.id}.zip"] = zipped({page: file.read_bytes()}, modes={page: 0o444})
    for file in folder.glob("*.zip"):
        if file.name not in zips:
            file.unlink()
    for name, content in zips.items():
        (folder / name).unlink(missing_ok=True)
        (folder / name).write_bytes(content)
        os.chmod(folder / name, 0o444)  # noqa: PTH101
    return folder
