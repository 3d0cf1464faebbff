"""A chapter of the real course, built and run in a copy of the course."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from course_folder import CourseFolder

ROOT = Path(__file__).parents[3]


def executed(root: Path, name: str) -> Any:
    """Return the chapter's notebook with its outputs, made in `root`."""
    shutil.copy(ROOT / "course.toml", root)
    for folder in ("chapters", "exercises", "solutions"):
        shutil.copytree(ROOT / folder, root / folder)
    course = CourseFolder(root)
    said = course.spinbook("build", "--execute", name)
    assert said.returncode == 0, said.stdout + said.stderr
    return course.notebook(name, "executed")
