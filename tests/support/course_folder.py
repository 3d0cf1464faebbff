"""A small course for a test."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
from prepared_python import run_prepared


class CourseFolder:
    """A small course in a temporary folder, in which `spinbook` can be run."""

    def __init__(self, root: Path) -> None:
        self.root = root
        (root / "chapters").mkdir(parents=True, exist_ok=True)

    def write(self, **chapters: str | bytes) -> CourseFolder:
        """Write chapters by name, and a course.toml that lists every chapter, by name."""
        for name, text in chapters.items():
            file = self.root / "chapters" / f"{name}.md"
            file.write_bytes(text if isinstance(text, bytes) else text.encode())
        names = sorted(file.name for file in (self.root / "chapters").glob("*.md"))
        listed = ", ".join(f'"chapters/{name}"' for name in names)
        (self.root / "course.toml").write_text(
            f'title = "A course"\nchapters = [{listed}]\n[package]\nname = "robot"\nworkspace = "robot_ws"\n'
        )
        return self

    def spinbook(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run the command in the course's folder."""
        return run_prepared("spinbook", *words, cwd=self.root)

    def spinbook_from_scratch(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run the command in a new Python: sets have another order in each."""
        return subprocess.run(
            [sys.executable, "-m", "spinbook", *words], cwd=self.root, capture_output=True, text=True, timeout=560
        )

    def notebook(self, name: str, folder: str = "notebooks") -> Any:
        """Return a built notebook (or an executed one)."""
        return nbformat.read(self.root / "build" / folder / f"{name}.ipynb", as_version=4)

    def outputs(self, name: str) -> dict[str, str]:
        """Return cell id -> all the text that an executed chapter's cell shows, errors included."""
        return {
            cell.id: "".join(output.get("text", "") + "\n".join(output.get("traceback", [])) for output in cell.outputs)
            for cell in self.notebook(name, "executed").cells
            if cell.cell_type == "code"
        }
