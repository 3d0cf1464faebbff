"""Reads a handout (a folder or a zip), and the original files of the last one in a student's folder."""

from __future__ import annotations

import re
import stat
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath

from groundwork.problem import Problem
from spinbook.problem import SpinbookError

#: The folder with the original files, in the handout and in the student's folder.
BASE = PurePosixPath(".spinbook/base")

#: Files that students may want to change. All others come from the handout.
_REMEMBERED = {".ipynb", ".md", ".py", ".toml", ".txt", ".yml"}


def is_remembered(path: PurePosixPath) -> bool:
    """Return whether a handout's file, by its path in it, is stored for later updates."""
    return path.suffix in _REMEMBERED and path.parts[0] != ".spinbook"


def base_files(handout: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the additional files that a handout of these files, by name, needs for later updates."""
    return {str(BASE / name): content for name, content in handout.items() if is_remembered(PurePosixPath(name))}


MOST_FILES = 5_000
MOST_BYTES = 500_000_000

#: Files that editors, Python and students leave in folders, and that are never part of a handout.
_LEFT_OUT = {"__pycache__", ".ipynb_checkpoints", ".git", ".venv", "backups"}

Files = dict[PurePosixPath, bytes]

_GIVE = "Give the course's new handout, a folder or a zip."

#: The line of a notebook's set-up cell that names the course's package, as it is in the notebook's JSON.
_PACKAGE = re.compile(rb"%chapter [^\n\"\\]*--package ([a-z0-9_]+)")


def read_handout(path: Path) -> Files:
    """Return a handout's files by their paths in it. Raises `SpinbookError` if it can't be read or isn't a handout."""
    if not path.exists():
        raise SpinbookError(Problem(path, None, "there is no such file or folder.", "Name the new handout."))
    try:
        files = _of_folder(path) if path.is_dir() else _of_zip(path)
    except (OSError, zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError) as error:
        reason = f"it can't be read: {error}."
        raise SpinbookError(Problem(path, None, reason, "Download the handout once more.")) from None
    files = _without_outer_folder(files)
    if reason := _why_not(files):
        raise SpinbookError(Problem(path, None, reason, f"Nothing was changed. {_GIVE}"))
    return files


def refuse_another_course(path: Path, files: Files, folder: Path) -> None:
    """Raise `SpinbookError` if a handout's notebooks and the student's are from different courses."""
    base = folder / BASE
    mine = packages(file.read_bytes() for file in sorted((base if base.is_dir() else folder).glob("*.ipynb")))
    new = packages(data for path, data in files.items() if path.suffix == ".ipynb" and len(path.parts) == 1)
    if mine and new and not mine & new:
        problem = f"it is a handout of another course: its package is {_and(new)}, yours is {_and(mine)}."
        raise SpinbookError(Problem(path, None, problem, f"Nothing was changed. {_GIVE}"))


def packages(notebooks: Iterable[bytes]) -> set[str]:
    """Return the ROS packages that these notebooks' set-up cells name, one for each course."""
    return {match.decode() for notebook in notebooks for match in _PACKAGE.findall(notebook)}


def _why_not(files: Files) -> str:
    """Say why this is not a handout; empty if it is one."""
    from grader.submission.upload import RECORD  # with the grader, which `spinbook doctor` does not need 18 times

    if PurePosixPath(RECORD) in files:
        return "it is not a handout, but a file to hand in that `spinbook submit` wrote."
    if not any(path.suffix == ".ipynb" for path in files):
        return "there is no notebook in it."
    if not any(path.is_relative_to(BASE) for path in files):
        return f"it is not a handout: there is no {BASE} in it."
    return ""


def _and(names: Iterable[str]) -> str:
    return " and ".join(sorted(names))


def _of_folder(folder: Path) -> Files:
    files: Files = {}
    for path in sorted(folder.rglob("*")):
        name = PurePosixPath(path.relative_to(folder).as_posix())
        if path.is_file() and not path.is_symlink() and not _LEFT_OUT & set(name.parts):
            files[name] = path.read_bytes()
            _bounded(folder, len(files), 0)
    return files


def _of_zip(file: Path) -> Files:
    files: Files = {}
    left = MOST_BYTES
    with zipfile.ZipFile(file) as archive:
        entries = [entry for entry in archive.infolist() if not entry.is_dir() and "__MACOSX" not in entry.filename]
        _bounded(file, len(entries), 0)
        for entry in entries:
            path = PurePosixPath(entry.filename)
            if path.is_absolute() or ".." in path.parts or "\\" in entry.filename or "\0" in entry.filename:
                problem = f"{entry.filename!r} in it leads out of its folder."
                raise SpinbookError(Problem(file, None, problem, "This is not a handout. Nothing was changed."))
            if stat.S_ISLNK(entry.external_attr >> 16):
                problem = f"{entry.filename!r} in it is a symbolic link."
                raise SpinbookError(Problem(file, None, problem, "This is not a handout. Nothing was changed."))
            with archive.open(entry) as opened:
                files[path] = opened.read(left + 1)
            left -= len(files[path])
            _bounded(file, 0, MOST_BYTES - left)
    return files


def _bounded(path: Path, count: int, size: int) -> None:
    if count > MOST_FILES or size > MOST_BYTES:
        problem = f"it holds more than {MOST_FILES} files or {MOST_BYTES // 1_000_000} MB."
        raise SpinbookError(Problem(path, None, problem, "Give the course's new handout, a folder or a zip."))


def _without_outer_folder(files: Files) -> Files:
    """Remove the one folder that a zip often has around everything."""
    outer = {path.parts[0] for path in files}
    if len(outer) == 1 and all(len(path.parts) > 1 for path in files) and not outer & {".spinbook"}:
        return {PurePosixPath(*path.parts[1:]): data for path, data in files.items()}
    return files
