"""Finds the file in a student's folder that holds an exercise."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path

from grader.exercise import Exercise, starter
from grader.submission import Submission, read
from grader.submission.notebook import NoCell, cells_of
from spinbook.update.base import BASE


@dataclass(frozen=True)
class Candidate:
    """What the student may want to hand in: the exercise's code, and the file it is from, if there is one.

    `origin` tells where the code is from, in words or by the file's name.
    """

    file: Path | None
    submission: Submission
    origin: str


def candidates(exercise: Exercise, folder: Path) -> list[Candidate]:
    """The files that hold the exercise: notebooks in `folder`, and the .py of its name there or in the exercise's own.

    Where there are several, those with the untouched starter don't count beside one with more in it, and two with the
    same code count once.
    """
    files = [folder / exercise.file_name, *sorted(folder.glob("*.ipynb")), exercise.folder / exercise.file_name]
    found = [Candidate(file, read(str(file), exercise), _name(file, folder)) for file in files if file.is_file()]
    found = [candidate for candidate in found if candidate.submission.program]
    begun = [candidate for candidate in found if not is_starter(candidate, exercise)]
    by_code = {_bare(candidate.submission.source): candidate for candidate in reversed(begun or found)}
    return [candidate for candidate in found if candidate in by_code.values()]


def is_starter(candidate: Candidate, exercise: Exercise) -> bool:
    """Whether this is the starter still, as it was handed out."""
    return _bare(candidate.submission.source) in _starters(exercise)


def cells_that_differ(candidate: Candidate, exercise: Exercise) -> int:
    """How many different cells the candidate's notebook has for the exercise; 1 where the code is from elsewhere."""
    if candidate.file is None or candidate.file.suffix != ".ipynb":
        return 1
    with contextlib.suppress(OSError, NoCell):
        return len({_bare(code) for code in cells_of(candidate.file.read_bytes(), exercise)})
    return 1


def _name(file: Path, folder: Path) -> str:
    return file.relative_to(folder).as_posix() if file.is_relative_to(folder) else str(file)


def _starters(exercise: Exercise) -> set[str]:
    """The starter as it was handed out, where that is known."""
    handed_out = exercise.folder.parent.parent / BASE / "exercises" / exercise.name / exercise.file_name
    found = set()
    with contextlib.suppress(OSError, ValueError):
        found.add(_bare(handed_out.read_text(encoding="utf-8")))
    with contextlib.suppress(OSError, ValueError):
        if exercise.solution_file:
            found.add(_bare(starter(exercise.solution_file.read_text(encoding="utf-8"))))
    return found


def _bare(code: str) -> str:
    """Code as it counts for a comparison: a cell ends without a line end, and begins with an emptied line of magic."""
    return code.replace("\r\n", "\n").strip()
