"""Puts an upload together and writes it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from grader.exercise import Exercise
from grader.grading.versions import versions
from grader.sandbox import choose_middleware
from grader.submission.upload import pack
from spinbook import __version__
from spinbook.submit.candidates import Candidate
from spinbook.submit.self_check import SelfCheck
from spinbook.written import write_if_changed

#: A notebook larger than this (bytes) stays at home; its cell is in the upload in any case.
LARGEST_NOTEBOOK = 2_500_000


@dataclass(frozen=True)
class HandIn:
    """What is handed in, by whom, and what the public checks say of it."""

    exercise: Exercise
    work: Candidate
    student: str
    check: SelfCheck


def write_upload(hand_in: HandIn, target: Path) -> None:
    """Write the upload to `target`, whole or not at all. Raises `OSError`."""
    exercise, file, program = hand_in.exercise, hand_in.work.file, hand_in.work.submission.program
    assert program
    files = {exercise.file_name: program.files[exercise.file_name]}
    if file is not None and file.suffix == ".ipynb" and file.stat().st_size <= LARGEST_NOTEBOOK:
        files[file.name] = file.read_bytes()
    record = {
        "exercise": exercise.name,
        "student": hand_in.student,
        "from": hand_in.work.origin,
        "time": _now().isoformat(),
        "versions": {**versions(choose_middleware().middleware), "spinbook": __version__},
        "self_check": hand_in.check.record,
    }
    write_if_changed(target, pack(record, files))


def default_target(exercise: Exercise, folder: Path) -> Path:
    """Where the upload goes if nobody says."""
    return folder / f"{exercise.name}-submission.zip"


def _now() -> datetime:
    """The time, to the second; SOURCE_DATE_EPOCH (s) stands in for the clock where uploads have to be reproducible."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if given.isdigit():
        return datetime.fromtimestamp(int(given), timezone.utc)
    return datetime.now(timezone.utc).replace(microsecond=0)
