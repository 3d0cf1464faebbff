"""A chapter of the real course, built and run in a copy of the course, whole or some sections of it."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import nbformat
from course_folder import CourseFolder

ROOT = Path(__file__).parents[3]


def executed(root: Path, name: str, titles: tuple[str, ...] = ()) -> Any:
    """Return the chapter's notebook with its outputs, made in `root`; with `titles`, only these sections."""
    shutil.copy(ROOT / "course.toml", root)
    for folder in ("chapters", "exercises", "solutions"):
        shutil.copytree(ROOT / folder, root / folder)
    if titles:
        _keep(root / "chapters" / f"{name}.md", titles)
    said = CourseFolder(root).spinbook("build", "--execute", name)
    assert said.returncode == 0, said.stdout + said.stderr
    return nbformat.read(root / "build" / "executed" / f"{name}.ipynb", as_version=4)


def _keep(chapter: Path, titles: tuple[str, ...]) -> None:
    """Remove every section and subsection of a chapter but these."""
    head, *sections = re.split(r"(?m)^(?=###? )", chapter.read_text(encoding="utf-8"))
    kept = [section for section in sections if section.partition("\n")[0].lstrip("# ") in titles]
    assert len(kept) == len(titles), "a section has another title now"
    chapter.write_text(head + "".join(kept), encoding="utf-8")
