"""An exercise with its solution as plain data, to be sent to another machine."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from grader.exercise import Exercise


@dataclass(frozen=True)
class Parcel:
    """The files that grading needs, by their paths below a course's folder."""

    exercise: str
    files: dict[str, bytes]

    @property
    def digest(self) -> str:
        """SHA-256 of all of it."""
        total = hashlib.sha256(self.exercise.encode())
        for name, content in sorted(self.files.items()):
            total.update(f"{name} {len(content)}\n".encode())
            total.update(content)
        return total.hexdigest()

    def unpack(self, into: Path) -> Path:
        """Write the files into the folder `into`; returns the exercise's folder."""
        for name, content in self.files.items():
            file = into / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        return into / "exercises" / self.exercise


def pack(exercise: Exercise) -> Parcel:
    """The exercise's folder, and of its solutions the author's own."""
    name = exercise.name
    found = [file for file in sorted(exercise.folder.rglob("*")) if file.is_file() and "__pycache__" not in file.parts]
    files = {f"exercises/{name}/{file.relative_to(exercise.folder).as_posix()}": file.read_bytes() for file in found}
    if exercise.solution_file:
        files[f"solutions/{name}/solution.py"] = exercise.solution_file.read_bytes()
    return Parcel(name, files)
