"""The folder with a class's results: a folder a student, whose grade.json is written last."""

from __future__ import annotations

import contextlib
import fcntl
import gzip
import os
import zlib
from pathlib import Path
from types import TracebackType

from grader.classroom import Entry
from grader.classroom.store import STUDENTS, folder_of, from_json, to_json
from grader.classroom.writing import write, write_bytes
from grader.recording import Recording
from grader.recording.store import from_json as recordings_from_json
from grader.recording.store import to_json as recordings_to_json

#: In a student's folder: what was recorded, as JSON below a line with the key of what it depends on.
RECORDINGS = "recordings.json.gz"


class Busy(Exception):
    """Raised when another grading is writing into the same folder."""


class Results:
    """One folder of results. Use it as a context manager: nobody else writes into it meanwhile."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._lock = -1

    def entry(self, student: str) -> tuple[Entry, str] | None:
        """What is kept of a student, and the key of the grade; None where nothing is, or nothing that can be read."""
        try:
            return from_json((folder_of(self.folder, student) / "grade.json").read_text(encoding="utf-8"))
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None

    def plot(self, student: str) -> str | None:
        """The picture that is kept of a student's run."""
        try:
            return (folder_of(self.folder, student) / "plot.svg").read_text(encoding="utf-8")
        except (OSError, ValueError):
            return None

    def recordings(self, student: str, key: str) -> dict[str, Recording] | None:
        """What is kept of a student's run, by scenario; None where nothing is kept under this key."""
        try:
            content = (folder_of(self.folder, student) / RECORDINGS).read_bytes()
            first, _, text = gzip.decompress(content).decode().partition("\n")
            return recordings_from_json(text) if first == key else None
        except (OSError, EOFError, zlib.error, ValueError, KeyError, TypeError):
            return None

    def keep_recordings(self, student: str, key: str, recordings: dict[str, Recording]) -> None:
        """Keep what was recorded of a student's run, so that changed checks can judge it."""
        content = gzip.compress(f"{key}\n{recordings_to_json(recordings)}".encode(), mtime=0)
        write_bytes(folder_of(self.folder, student) / RECORDINGS, content)

    def write(self, entry: Entry, key: str, page: str, plot: str | None) -> None:
        """Keep a student's entry. Whenever this is broken off, what is there is whole, or is made again."""
        folder = folder_of(self.folder, entry.student.id)
        text = to_json(entry, key)
        try:
            if (folder / "grade.json").read_text(encoding="utf-8") != text:
                # What it vouches for is about to change.
                (folder / "grade.json").unlink()
        except (OSError, ValueError):
            pass
        write(folder / "feedback.html", page)
        if plot is not None:
            write(folder / "plot.svg", plot)
        else:
            (folder / "plot.svg").unlink(missing_ok=True)
        write(folder / "grade.json", text)

    def forget(self, student: str) -> None:
        """Take away what vouches for a student's results, so that the next run grades the submission again."""
        with contextlib.suppress(OSError):
            (folder_of(self.folder, student) / "grade.json").unlink(missing_ok=True)

    def others(self, students: set[str]) -> tuple[str, ...]:
        """Whose results are here beside those of `students`."""
        return tuple(
            sorted(
                file.parent.name
                for file in self.folder.glob(f"{STUDENTS}/*/grade.json")
                if file.parent.name not in students
            )
        )

    def __enter__(self) -> Results:
        self.folder.mkdir(parents=True, exist_ok=True)
        self._lock = os.open(self.folder / ".lock", os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, 0o644)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._lock)
            raise Busy(f"{self.folder}: another grading is at work in this folder. Wait for its end.") from None
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._lock)
