"""Reads a submission, whatever it is. Content that is no use is the student's to hear of, and never ends the grader."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from pathlib import Path

from grader.exercise import Exercise
from grader.sandbox import Program
from grader.submission.executable import find
from grader.submission.notebook import NoCell, cell_of
from grader.submission.submission import Submission

MOST_BYTES = {".py": 1_000_000, ".ipynb": 30_000_000}


class NoSubmission(Exception):
    """Raised when there is nothing to grade under the name that was given: a mistake in the command's usage."""


class _Unusable(Exception):
    pass


def read(given: str, exercise: Exercise) -> Submission:
    """The submission that `given` names: a .py or .ipynb file, or `package/executable` of an installed package."""
    path = Path(given)
    if path.suffix not in MOST_BYTES and not os.path.lexists(path):
        if given.count("/") == 1:
            return _executable(given, exercise)
        raise NoSubmission(f"{given}: there is no such file. Give a .py or .ipynb file, or package/executable.")
    if path.suffix not in MOST_BYTES:
        raise NoSubmission(f"{given}: give a .py or .ipynb file, or package/executable of an installed package.")
    if not os.path.lexists(path):
        raise NoSubmission(f"{given}: there is no such file.")
    try:
        content = _content(path)
    except _Unusable as error:
        return Submission(given, _digest(str(error).encode()), exercise.file_name, "", None, str(error))
    if path.suffix == ".ipynb":
        try:
            code = cell_of(content, exercise).encode()
        except NoCell as error:
            return Submission(given, _digest(content), exercise.file_name, "", None, str(error))
    else:
        code = content
    return of_source(given, code, exercise, _digest(content))


def of_source(name: str, code: bytes, exercise: Exercise, digest: str = "") -> Submission:
    """A submission of this Python source. It runs under the exercise's file name, whatever it was called."""
    source = code.decode("utf-8", errors="replace")
    program = Program(exercise.file_name, {exercise.file_name: code})
    problem = "" if code.strip() else "Your file is empty."
    return Submission(name, digest or _digest(code), exercise.file_name, source, None if problem else program, problem)


def _content(path: Path) -> bytes:
    """What is in a file, of the file itself and of nothing that it points to."""
    most = MOST_BYTES[path.suffix]
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise _Unusable("It is a symbolic link. Hand in the file itself.") from None
        raise _Unusable(f"It can't be read: {error.strerror}.") from None
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise _Unusable("It is no regular file. Hand in a file.")
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            content = file.read(most + 1)
    finally:
        os.close(descriptor)
    if len(content) > most:
        raise _Unusable(f"It is larger than {most // 1_000_000} MB. Hand in your code only, with outputs cleared.")
    return content


def _executable(given: str, exercise: Exercise) -> Submission:
    found = find(given)
    if isinstance(found, str):
        raise NoSubmission(found)
    source = found.script.read_bytes()
    program = Program(
        str(found.script), environment={"PYTHONPATH": found.python_path}, readonly=found.folders, warm=False
    )
    return Submission(given, found.digest(), found.script.name, source.decode(errors="replace"), program)


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
