"""What is wrong in an exercise is its author's to mend, never a student's loss."""

from __future__ import annotations

from pathlib import Path


class ExerciseError(Exception):
    """Raised before any student is graded, when an exercise can't be used as its author wrote it.

    `found` says what stands in the file, `mend` what was expected and what to do. `line` counts from 1, and is
    None where the whole file is meant.
    """

    def __init__(self, file: Path, found: str, mend: str, line: int | None = None) -> None:
        self.file, self.line, self.found, self.mend = file, line, found, mend
        place = f"{file}:{line}" if line is not None else f"{file}"
        super().__init__(f"{place}: {found}\n    {mend}")

    def __reduce__(self) -> tuple[type[ExerciseError], tuple[Path, str, str, int | None]]:
        """Keep all four parts when the error crosses from one process to another."""
        return ExerciseError, (self.file, self.found, self.mend, self.line)
