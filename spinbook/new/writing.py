"""Makes a course or an exercise from the templates, which are plain files next to this one.

Nothing is ever overwritten: what is made is put together in a folder of its own, which then gets its name.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from spinbook.new.kind import COURSE, Kind
from spinbook.new.names import class_name, words
from spinbook.problem import Problem, SpinbookError

#: The exercise of a new course.
EXERCISE = "speed_limit"

#: Files whose names begin with a dot in a course, but not here, where packaging tools would leave them out.
_DOTTED = ("_gitignore", "_github")


def write_course(folder: Path, title: str, package: str) -> None:
    """Make a course in `folder`, which must not exist. Raises `SpinbookError`."""
    names = {"My first course": title, "my_first_course": package}
    _refuse_existing(folder)
    _put(_filled(COURSE, names), folder)


def write_exercise(course: Path, name: str, title: str, kind: Kind) -> None:
    """Make an exercise of a kind, and its solutions, in a course. Raises `SpinbookError` if a folder of it exists."""
    names = {
        kind.exercise: name,
        class_name(kind.exercise): class_name(name),
        kind.title: title,
        words(kind.exercise).lower(): words(name).lower(),
    }
    folders = {part: course / part / name for part in ("exercises", "solutions")}
    for folder in folders.values():
        _refuse_existing(folder)
    for part, folder in folders.items():
        _put(_filled(kind.root / part / kind.exercise, names), folder)


def _refuse_existing(folder: Path) -> None:
    if folder.exists() or folder.is_symlink():
        found = "there is something of that name already."
        raise SpinbookError(
            Problem(folder, None, found, "Nothing is overwritten: choose another name, or move it away.")
        )


def _filled(template: Path, names: Mapping[str, str]) -> dict[Path, str]:
    """The template's files by their places in what is made, with other names in them."""
    files: dict[Path, str] = {}
    for file in sorted(template.rglob("*")):
        place = file.relative_to(template)
        if not file.is_file() or "__pycache__" in place.parts:
            continue
        first = place.parts[0]
        if first in _DOTTED:
            place = Path(f".{first[1:]}", *place.parts[1:])
        text = file.read_text(encoding="utf-8")
        for old, new in names.items():
            text = text.replace(old, new)
        files[place] = text
    return files


def _put(files: Mapping[Path, str], folder: Path) -> None:
    """Write the files, all or none."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{folder.name}-", dir=folder.parent) as temporary:
            whole = Path(temporary) / folder.name
            for place, text in files.items():
                target = whole / place
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(text, encoding="utf-8")
            shutil.move(whole, folder)
    except OSError as error:
        found = f"it can't be made: {error.strerror}."
        raise SpinbookError(Problem(folder, None, found, "Choose a place where you may write.")) from None
