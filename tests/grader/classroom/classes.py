"""Exports of a class as platforms write them, to be collected."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from grader.classroom.collector import CollectOptions, collect
from grader.classroom.submissions import Submissions
from grader.exercise import load

ROOT = Path(__file__).parents[3]
EXERCISE = "joint_velocity"


def folder(root: Path, files: Mapping[str, str] | list[str]) -> Path:
    """Write files below `root`; those without a content have their own name in it."""
    for name, content in (files if isinstance(files, Mapping) else {name: f"# {name}\n" for name in files}).items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(content, encoding="utf-8")
    return root


def archive(file: Path, files: Mapping[str, str] | list[str]) -> Path:
    """Write a zip whose entries all have the date of the download."""
    with zipfile.ZipFile(file, "w") as out:
        for name, content in (files if isinstance(files, Mapping) else {name: f"# {name}\n" for name in files}).items():
            out.writestr(zipfile.ZipInfo(name, (2026, 11, 25, 8, 0, 0)), content)
    return file


def collected(source: Path, **options: Any) -> Submissions:
    """Return what the class handed in."""
    return collect(
        source,
        load(ROOT / "exercises" / EXERCISE),
        Path(tempfile.mkdtemp(dir=source.parent)),
        CollectOptions(**options),
    )


def files(submissions: Submissions) -> dict[str, str]:
    """Return each student's file."""
    return {one.student.id: one.file.name for one in submissions.handed_in}
