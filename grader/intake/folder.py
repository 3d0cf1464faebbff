"""Files in a folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from datetime import datetime, timezone
from pathlib import Path

from grader.classroom import Skipped, Student
from grader.intake.handed_in import File, Sorted, student_id

#: Made by operating systems, editors and Python, never by a student.
NOISE = {"__MACOSX", "__pycache__", "Thumbs.db", "desktop.ini"}
WHY_NOISE = "made by a program, not handed in"


def is_noise(name: str) -> bool:
    """Whether a file or folder of this name is of no interest."""
    return name in NOISE or name.startswith(".")


def walk(root: Path) -> Iterator[File | Skipped]:
    """Every file below `root`, in order of names; symbolic links are not followed."""
    for folder, folders, names in os.walk(root):
        inside = Path(folder).relative_to(root)
        for name in sorted([*folders, *names]):
            if is_noise(name):
                yield Skipped((inside / name).as_posix(), WHY_NOISE)
        folders[:] = sorted(name for name in folders if not is_noise(name))
        for name in sorted(names):
            if not is_noise(name):
                path = Path(folder, name)
                yield File((inside / name).as_posix(), path, date_of(path), "the file's date")


def date_of(path: Path) -> datetime | None:
    """Return the file's date; an archive can give a file one that no calendar has."""
    try:
        return datetime.fromtimestamp(path.lstat().st_mtime, timezone.utc)
    except (OSError, ValueError, OverflowError):
        return None


def by_student(files: list[File]) -> Sorted:
    """STUDENT.py, or a folder a student with a file in it."""
    found = []
    for file in files:
        top = file.parts[0]
        name = top if len(file.parts) > 1 else top.rpartition(".")[0] or top
        found.append((Student(student_id(name), name if name != student_id(name) else ""), file))
    return Sorted("a folder with a file or a folder a student", tuple(found))
