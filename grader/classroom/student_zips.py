"""One zip per student, to hand out: the feedback page, without anything about other students or hidden checks."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Sequence
from pathlib import Path

from grader.grading.grade import Entry
from grader.report.as_json import folder_of

FOLDER = "to-students"

#: The same content gives the same bytes: every entry has the earliest date that a zip can contain.
DATE = (1980, 1, 1, 0, 0, 0)


def publish(results: Path, entries: Sequence[Entry]) -> Path:
    """Write a read-only `to-students/STUDENT.zip` per entry, and return the folder. Other zips are removed."""
    folder = results / FOLDER
    folder.mkdir(exist_ok=True)
    zips = {f"{entry.student.id}.zip": _zip(results, entry) for entry in entries}
    for file in folder.glob("*.zip"):
        if file.name not in zips:
            file.unlink()
    for name, content in zips.items():
        (folder / name).unlink(missing_ok=True)
        (folder / name).write_bytes(content)
        os.chmod(folder / name, 0o444)  # noqa: PTH101
    return folder


def _zip(results: Path, entry: Entry) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        page = zipfile.ZipInfo(f"{entry.grade.exercise}/feedback.html", DATE)
        page.external_attr = 0o100444 << 16
        page.compress_type = zipfile.ZIP_DEFLATED
        archive.writestr(page, (folder_of(results, entry.student.id) / "feedback.html").read_bytes())
    return out.getvalue()
