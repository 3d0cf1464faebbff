"""Finds the exercise in a student's folder, checks it, and writes the one file to upload."""

from __future__ import annotations

import contextlib
import os
import sys
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import click

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import find, load
from grader.exercise.starter import starter
from grader.grading.grade import Grade
from grader.grading.grading import grade_submission
from grader.grading.reference import versions
from grader.report.hint_steps import taken, taken_in_page
from grader.sandbox.program import SandboxUnavailable
from grader.submission.file_kinds import can_be_read, kind_of
from grader.submission.launch_program import is_called
from grader.submission.reader import read
from grader.submission.submission import Submission
from grader.submission.upload import pack
from grader.workers.pool import HostFault
from groundwork.files import write_if_changed
from groundwork.problem import Problem
from spinbook import __version__
from spinbook.problem import SpinbookError
from spinbook.update.handout import BASE


@dataclass(frozen=True)
class HandInCandidate:
    """Code that the student may want to hand in, and the file it is from, if there is one.

    `origin` says where the code is from, in words or by the file's name.
    """

    file: Path | None
    submission: Submission
    origin: str


def candidates(exercise: Exercise, folder: Path) -> list[HandInCandidate]:
    """Return the files that hold the exercise: notebooks, ROS 2 packages and launch files of its name in `folder`, and
    the .py of its name, there or in the exercise's own folder. If it is unclear which program is meant, the submission
    has a question in place of a program.

    If there are several, unchanged starters do not count next to changed ones, and the same code counts once.
    """
    files = [folder / exercise.file_name, *sorted(folder.glob("*.ipynb")), *_packages(folder)]
    if exercise.nodes:
        files += [file for file in sorted(folder.glob("*launch.[xy]*ml")) if is_called(file.name, exercise)]
    files.append(exercise.folder / exercise.file_name)
    submissions = {file: read(str(file), exercise) for file in files if file.exists()}
    candidates = [
        HandInCandidate(file, submission, _name(file, folder))
        for file, submission in submissions.items()
        if submission.program or submission.question
    ]
    begun = [candidate for candidate in candidates if not is_starter(candidate, exercise)]
    by_code = {_bare(candidate.submission.source): candidate for candidate in reversed(begun or candidates)}
    return [candidate for candidate in candidates if candidate in by_code.values()]


def _packages(folder: Path) -> list[Path]:
    """Return the ROS 2 packages in a folder, or in a workspace in it."""
    patterns = ("package.xml", "*/package.xml", "src/*/package.xml", "*/src/*/package.xml")
    return sorted({manifest.parent for pattern in patterns for manifest in folder.glob(pattern)})


def is_starter(candidate: HandInCandidate, exercise: Exercise) -> bool:
    """Return whether the code is still the unchanged starter."""
    return _bare(candidate.submission.source) in _starters(exercise)


def _name(file: Path, folder: Path) -> str:
    return file.relative_to(folder).as_posix() if file.is_relative_to(folder) else str(file)


def _starters(exercise: Exercise) -> set[str]:
    """Return the starter as it was handed out, if that is known."""
    handed_out = exercise.folder.parent.parent / BASE / "exercises" / exercise.name / exercise.file_name
    starters = set()
    with contextlib.suppress(OSError, ValueError):
        starters.add(_bare(handed_out.read_text(encoding="utf-8")))
    with contextlib.suppress(OSError, ValueError):
        if exercise.solution_file:
            starters.add(_bare(starter(exercise.solution_file.read_text(encoding="utf-8"))))
    return starters


def _bare(code: str) -> str:
    """Return code for comparison: a cell has no line end at its end, and an empty line in place of its magic."""
    return code.replace("\r\n", "\n").strip()


@dataclass(frozen=True)
class SelfCheck:
    """The public part of a grade, or `why` there is none. It is never the official grade."""

    grade: Grade | None
    why: str = ""

    @property
    def record(self) -> dict[str, Any]:
        """The result as plain data, for the upload's record."""
        if self.grade is None:
            return {"not_run": self.why}
        return {
            "outcome": self.grade.outcome,
            "score": self.grade.score,
            "points": self.grade.points,
            "isolation": self.grade.isolation,
            "checks": {verdict.name: verdict.status for verdict in self.grade.verdicts},
        }


def self_check(exercise: Exercise, submission: Submission) -> SelfCheck:
    """Run the public checks. Never raises: a failure must not keep anybody from handing in."""
    try:
        grade = grade_submission(exercise.public(), submission)
    except KeyboardInterrupt:
        return SelfCheck(None, "It was interrupted.")
    except ExerciseError as error:
        return SelfCheck(None, f"The checks can't run here: {error.problem.problem} ({error.problem.file.name}).")
    except (SandboxUnavailable, HostFault) as error:
        return SelfCheck(None, f"The machine or the grader is at fault, not your code: {str(error).rstrip('.')}.")
    except Exception as error:
        return SelfCheck(None, f"{type(error).__name__}: {error}")
    if not grade.has_score:
        return SelfCheck(None, grade.message)
    return SelfCheck(replace(grade, submission=Path(grade.submission).name))


#: A notebook larger than this (bytes) is left out of the upload; its cell is always in the upload.
LARGEST_NOTEBOOK = 2_500_000


@dataclass(frozen=True)
class HandIn:
    """What is handed in, by whom, and the result of the public checks."""

    exercise: Exercise
    work: HandInCandidate
    student: str
    check: SelfCheck


def write_upload(hand_in: HandIn, target: Path) -> None:
    """Write the upload to `target`, completely or not at all. Raises `OSError`."""
    exercise, file, program = hand_in.exercise, hand_in.work.file, hand_in.work.submission.program
    assert program
    files = dict(program.files)
    if file is not None and kind_of(file.name) == "notebook" and file.stat().st_size <= LARGEST_NOTEBOOK:
        files[file.name] = file.read_bytes()
    record = {
        "exercise": exercise.name,
        "student": hand_in.student,
        "from": hand_in.work.origin,
        "time": _now().isoformat(),
        "versions": {**versions(), "spinbook": __version__},
        "self_check": hand_in.check.record,
    }
    if exercise.count_hints:
        record["hints"] = taken(exercise, Path.cwd()) | taken_in_page(hand_in.work.submission.source)
    write_if_changed(target, pack(record, files))


def _now() -> datetime:
    """Return the time, to the second; SOURCE_DATE_EPOCH (s) replaces the clock if uploads have to be reproducible."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    if epoch.isdigit():
        return datetime.fromtimestamp(int(epoch), timezone.utc)
    return datetime.now(timezone.utc).replace(microsecond=0)


FILE = Path(".spinbook") / "student"

#: The longest name of a student (characters).
LONGEST = 200


def remembered_student(folder: Path) -> str | None:
    """Return the name stored in `folder` or above: empty if the student gave none, None if nobody has asked yet."""
    for place in (folder, *folder.parents):
        try:
            return (place / FILE).read_text(encoding="utf-8").strip()[:LONGEST]
        except (OSError, UnicodeDecodeError):
            continue
    return None


def remember_student(name: str, folder: Path) -> str:
    """Store a name in `folder`. Return it as stored, on one line."""
    kept = " ".join(name.split())[:LONGEST]
    write_if_changed(folder / FILE, kept + "\n")
    return kept


def exercise_named(name: str) -> Exercise:
    """Return the exercise `name` of the course in this folder. Raises `UsageError` and `ExerciseError`."""
    return load(find(name, Path.cwd()))


def candidate_in(file: Path, exercise: Exercise) -> HandInCandidate:
    """Return the code in the file that the student named. Raises `UsageError` and `SpinbookError`."""
    if not os.path.lexists(file) and not can_be_read(file.name):
        raise click.UsageError(f"{file}: give a notebook (.ipynb), a Python file (.py), an archive or a folder.")
    submission = read(str(file), exercise)
    if submission.program is None:
        raise SpinbookError(_no_program(file, submission))
    return HandInCandidate(file, submission, file.name)


def _no_program(file: Path, submission: Submission) -> Problem:
    if submission.question:
        return Problem(file, None, submission.question, "Nothing is handed in until only one of them is left.")
    return Problem(file, None, submission.problem, "There is no code for the exercise in it yet.")


def choose_candidate(exercise: Exercise, folder: Path, command: str, question: str) -> HandInCandidate:
    """Return the code in the one file of `folder` that holds the exercise; if there are several, the student chooses
    one.

    `command` is what the student typed. Raises `UsageError` and `SpinbookError`.
    """
    there = candidates(exercise, folder)
    if not there:
        problem = f"nothing here holds {exercise.name}: no {exercise.file_name}, and no notebook with its cell."
        fix = f"Go to the folder of your notebook, or name the file: {command} {exercise.name} FILE"
        raise SpinbookError(Problem(folder, None, problem, fix))
    if len(there) == 1:
        if there[0].submission.program is None:
            raise SpinbookError(_no_program(there[0].file or folder, there[0].submission))
        return there[0]
    listed = [candidate.origin for candidate in there]
    if not sys.stdin.isatty():
        raise click.UsageError(f"Which file? {', '.join(listed)}. Name it: {command} {exercise.name} FILE")
    click.echo("More than one file here holds this exercise:")
    for number, name in enumerate(listed, start=1):
        click.echo(f"  {number}  {name}")
    return there[click.prompt(question, type=click.IntRange(1, len(there))) - 1]
