"""Reads a submission: a file, a folder, an upload or an installed executable. Its program is read in `code`."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from grader.exercise.exercise import Exercise
from grader.sandbox.program import ProgramSpec
from grader.submission.archive import Contents, content_of, folder_contents
from grader.submission.code import Code, code_of, code_of_files, code_of_python
from grader.submission.file_kinds import MOST_BYTES_OF, can_be_read, kind_of, kind_of_content
from grader.submission.problems import AmbiguousProgram, Unreadable
from grader.submission.python_version import newer_than_this
from grader.submission.submission import Submission
from grader.submission.upload import RECORD, Upload, unpack

if TYPE_CHECKING:
    from grader.exercise.mistakes import Mistake


@dataclass(frozen=True)
class Executable:
    """An installed Python executable: its script, the folders that it needs, and where its modules are."""

    script: Path
    folders: tuple[Path, ...]
    python_path: str

    def digest(self) -> str:
        """The SHA-256 of the script and of every Python file next to its modules."""
        total = hashlib.sha256(self.script.read_bytes())
        for folder in self.python_path.split(os.pathsep):
            for file in sorted(Path(folder).rglob("*.py")):
                total.update(file.read_bytes())
        return total.hexdigest()


def find(place: str) -> Executable | str:
    """Return the executable that `package/executable` names, or a sentence that says why there is none."""
    package, _, name = place.partition("/")
    prefixes = [Path(prefix) for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    for prefix in prefixes:
        script = prefix / "lib" / package / name
        if script.is_file():
            return _described(prefix, script)
    looked = ", ".join(map(str, prefixes)) or "nowhere: AMENT_PREFIX_PATH is not set"
    return (
        f"{place}: there is no such file, and no package {package} with an executable {name} is installed (looked in "
        f"{looked}). Build the package with colcon and source install/setup.sh first."
    )


def _described(prefix: Path, script: Path) -> Executable:
    modules = [folder for folder in prefix.glob("lib/python3*/site-packages") if folder.is_dir()]
    folders = [prefix]
    for folder in list(modules):
        for link in folder.glob("*.egg-link"):
            # `colcon build --symlink-install` leaves the modules in the build and source folders.
            target = Path(link.read_text(encoding="utf-8").splitlines()[0])
            modules.append(target)
            folders += [target, *(entry.resolve().parent for entry in target.iterdir() if entry.is_symlink())]
    return Executable(script, tuple(folders), os.pathsep.join(map(str, modules)))


#: The suffixes of the files that are collected for a class, and the size limit for each (bytes).
MOST_BYTES = {suffix: MOST_BYTES_OF[kind_of(suffix)] for suffix in (".py", ".ipynb", ".zip")}

#: What says that there is no program to run.
NO_PROGRAM = (Unreadable, AmbiguousProgram)


class NoSubmission(click.UsageError):
    """Raised if there is nothing to grade under a name, because the command was used wrongly."""


def read(place: str, exercise: Exercise) -> Submission:
    """Return the submission that `place` names: a file, a folder, or `package/executable` of an installed package.

    A file is Python, a notebook, or an archive; one that can't be read is a submission with a `problem`. Raises
    `NoSubmission` if there is none.
    """
    try:
        return _read_path(place, Path(place), exercise)
    except OSError as error:
        raise NoSubmission(f"{error.filename}: it can't be read: {error.strerror}.") from None


def _read_path(place: str, path: Path, exercise: Exercise) -> Submission:
    if path.is_dir() and not path.is_symlink():
        return _folder(place, path, exercise)
    if not os.path.lexists(path):
        if not can_be_read(place) and place.count("/") == 1:
            return _executable(place)
        raise NoSubmission(
            f"{place}: there is no such file. Give a .py, .ipynb or .zip file, a folder, or package/executable."
        )
    try:
        content = content_of(path, MOST_BYTES_OF[kind_of(place)])
    except NO_PROGRAM as error:
        return _without_program(place, _digest(str(error).encode()), exercise, error)
    return of_content(place, content, exercise)


def is_one(folder: Path, exercise: Exercise) -> bool:
    """Return whether a folder is one submission and not a class: a package, a workspace, or the exercise's program."""
    patterns = [f"{'*/' * depth}{name}" for depth in range(4) for name in ("package.xml", "setup.py")]
    names = [exercise.file_name, *(program.file for program in exercise.programs)]
    return any((folder / name).is_file() for name in names) or any(next(folder.glob(one), None) for one in patterns)


def of_content(name: str, content: bytes, exercise: Exercise) -> Submission:
    """Return the submission in a file with this name and content."""
    if kind_of_content(content, kind_of(name)) == "archive":
        return of_upload(name, content, exercise)
    return _read(name, _digest(content), exercise, lambda: code_of(name, content, exercise))


def of_source(name: str, code: bytes, exercise: Exercise) -> Submission:
    """Return the submission of this Python source. It always runs under the exercise's file name."""
    submission = _read(name, _digest(code), exercise, lambda: code_of_python(code, exercise))
    return submission if submission.program else replace(submission, source=code.decode("utf-8", errors="replace"))


def of_mistake(mistake: Mistake, exercise: Exercise) -> Submission:
    """Return the submission of one of the exercise's usual mistakes."""
    return of_source(f"{mistake.name}.py", mistake.source.encode(), exercise)


def of_upload(name: str, content: bytes, exercise: Exercise) -> Submission:
    """Return the submission in an archive. `warning` says what in it does not match its record; it is graded anyway."""
    try:
        upload = unpack(content)
    except NO_PROGRAM as error:
        return _without_program(name, _digest(content), exercise, error)
    read = _read(name, _digest(content), exercise, lambda: _code(upload, exercise))
    read = replace(read, warning=_warning(upload, exercise))
    if not read.program:
        return read
    versions = upload.record.get("versions")
    python = versions.get("python", "") if isinstance(versions, dict) else ""
    newer = newer_than_this(python) if isinstance(python, str) else ""
    notes = (*read.notes, *_hints_taken(upload, exercise))
    return replace(read, notes=notes, newer_python=newer or read.newer_python)


def _hints_taken(upload: Upload, exercise: Exercise) -> tuple[str, ...]:
    """Return how many further hints the record counts, if the exercise counts them."""
    hints = upload.record.get("hints")
    if not exercise.count_hints or not isinstance(hints, dict):
        return ()
    return (f"Hints taken: {sum(steps for steps in hints.values() if isinstance(steps, int) and 0 < steps < 10)}.",)


def _code(upload: Upload, exercise: Exercise) -> Code:
    """Return the program: the file that the record names, if it does."""
    own = upload.files.get(exercise.file_name)
    if upload.has_record and own is not None:
        code = {name: data for name, data in upload.files.items() if kind_of(name) != "notebook"}
        if len(code) == 1:
            return code_of_python(own, exercise)
        return code_of_files(Contents(code), exercise)
    return code_of_files(upload.contents, exercise)


def _warning(upload: Upload, exercise: Exercise) -> str:
    faults = list(upload.faults)
    kinds = sorted(map(kind_of, upload.files))
    if not upload.has_record and exercise.file_name in upload.files and kinds == ["notebook", "python"]:
        faults.append(f"{RECORD} is missing: this file was not written by `spinbook submit`")
    if upload.record and upload.record.get("exercise") != exercise.name:
        faults.append(f"it was handed in for the exercise {upload.record.get('exercise')!r}")
    text = "; ".join(faults)
    return f"Not as it was handed in: {text[:500]}." if text else ""


def _folder(place: str, path: Path, exercise: Exercise) -> Submission:
    """Return the submission in a folder: a package, a workspace, or some files."""
    try:
        contents = folder_contents(path)
    except NO_PROGRAM as error:
        return _without_program(place, _digest(str(error).encode()), exercise, error)
    total = hashlib.sha256()
    for name, data in sorted(contents.files.items()):
        total.update(f"{name}\0{len(data)}\0".encode(errors="replace") + data)
    return _read(place, total.hexdigest(), exercise, lambda: code_of_files(contents, exercise, path.resolve().name))


def _read(name: str, digest: str, exercise: Exercise, code: Callable[[], Code]) -> Submission:
    """Return the submission of the program that `code` reads, or of none, with what is wrong."""
    try:
        return of_code(name, code(), exercise, digest)
    except NO_PROGRAM as error:
        return _without_program(name, digest, exercise, error)


def of_code(name: str, code: Code, exercise: Exercise, digest: str = "") -> Submission:
    """Return the submission of a program that has been read."""
    digest = digest or _digest(code.source.encode(errors="replace"))
    program = ProgramSpec(code.main, code.files)
    newer = newer_than_this(code.python)
    return Submission(name, digest, exercise.file_name, code.source, program, notes=code.notes, newer_python=newer)


def _without_program(name: str, digest: str, exercise: Exercise, why: Exception) -> Submission:
    nothing = Submission(name, digest, exercise.file_name, "", None)
    if isinstance(why, AmbiguousProgram):
        return replace(nothing, question=str(why))
    return replace(nothing, problem=str(why))


def _executable(place: str) -> Submission:
    found = find(place)
    if isinstance(found, str):
        raise NoSubmission(found)
    source = found.script.read_bytes()
    program = ProgramSpec(
        str(found.script), environment={"PYTHONPATH": found.python_path}, readonly=found.folders, preloaded=False
    )
    return Submission(place, found.digest(), found.script.name, source.decode(errors="replace"), program)


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
