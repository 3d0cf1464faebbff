"""What an update will do, decided before anything is done, and doing it: first a backup, then every file."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path, PurePosixPath

from grader.files import write_if_changed
from spinbook.update.handout import BASE, Files, is_remembered
from spinbook.update.merging import MergeReport
from spinbook.update.notebook import NoNotebook, chapter, merged_notebook, read

#: Folders in which a student's notebook is not looked for.
_NOT_LOOKED_IN = {".spinbook", ".ipynb_checkpoints", ".venv", "backups", "build"}


@dataclass
class Plan:
    """Files to write, what to tell of each, and entries of the base that are out of date.

    `report` has a line or more for each file, by the file's path; `notebooks` what became of cells.
    """

    writes: Files = field(default_factory=dict)
    report: dict[PurePosixPath, list[str]] = field(default_factory=dict)
    notebooks: dict[PurePosixPath, MergeReport] = field(default_factory=dict)
    base: Files = field(default_factory=dict)
    forgotten: list[PurePosixPath] = field(default_factory=list)

    def tell(self, place: PurePosixPath, line: str) -> None:
        """Add a line for the student about one file."""
        self.report.setdefault(place, []).append(line)


def plan(folder: Path, handout: Mapping[PurePosixPath, bytes]) -> Plan:
    """What brings the student's `folder` up to `handout`. Changes nothing."""
    made = Plan()
    base = _base_in(folder)
    for place, data in sorted(handout.items()):
        if place.parts[0] == ".spinbook":
            if not place.is_relative_to(BASE):
                _own(made, folder, place, data)
            continue
        if place.suffix == ".ipynb":
            _notebook(made, folder, place, base.get(place), data)
        else:
            _file(made, folder, place, base.get(place), data)
        if is_remembered(place) and base.get(place) != data:
            made.base[BASE / place] = data
    for place in sorted(set(base) - set(handout)):
        made.forgotten.append(BASE / place)
        if (folder / place).exists():
            made.tell(place, "is no longer part of the handout. Yours stays.")
    return made


def _base_in(folder: Path) -> Files:
    root = folder / BASE
    return {
        PurePosixPath(path.relative_to(root).as_posix()): path.read_bytes()
        for path in sorted(root.rglob("*"))
        if path.is_file()
    }


def _own(made: Plan, folder: Path, place: PurePosixPath, data: bytes) -> None:
    """A file of ours, which no student edits."""
    if _content(folder / place) != data:
        made.base[place] = data


def _file(made: Plan, folder: Path, place: PurePosixPath, base: bytes | None, new: bytes) -> None:
    mine = _content(folder / place)
    if mine == new or new == base:
        return
    if mine is None:
        made.writes[place] = new
        made.tell(place, "is new." if base is None else "was deleted here and has changed in the handout: it is back.")
    elif mine == base or not is_remembered(place) or (base is None and place.suffix != ".py"):
        made.writes[place] = new
        made.tell(place, "has changed in the handout: the new one is taken.")
    else:
        _beside(made, folder, place, new, "You have changed it and so has the handout. Yours is kept")


def _notebook(made: Plan, folder: Path, place: PurePosixPath, base: bytes | None, new: bytes) -> None:
    if new == base:
        return
    where = _students(folder, place, new)
    mine = _content(folder / where)
    if mine is None:
        made.writes[place] = new
        made.tell(place, "is new." if base is None else "was deleted here and has changed in the handout: it is back.")
        return
    if mine in (base, new):
        if mine != new:
            made.writes[where] = new
            made.tell(where, "has changed in the handout, and not here: the new one is taken.")
        return
    try:
        data, report = merged_notebook(base, mine, new)
    except NoNotebook as error:
        _beside(made, folder, where, new, f"Your notebook can't be read ({error}). It is kept")
        return
    if data != mine:
        made.writes[where] = data
        made.notebooks[where] = report
        made.report.setdefault(where, [])


def _students(folder: Path, place: PurePosixPath, new: bytes) -> PurePosixPath:
    """Where the student has this notebook, which may have another name by now."""
    if (folder / place).exists():
        return place
    try:
        wanted = chapter(read(new))
    except NoNotebook:
        return place
    found = []
    for path in sorted(folder.rglob("*.ipynb")):
        where = PurePosixPath(path.relative_to(folder).as_posix())
        if wanted and not _NOT_LOOKED_IN & set(where.parts) and _chapter_of(path) == wanted:
            found.append(where)
    return found[0] if len(found) == 1 else place


def _chapter_of(path: Path) -> str:
    try:
        return chapter(read(path.read_bytes()))
    except (OSError, NoNotebook):
        return ""


def _beside(made: Plan, folder: Path, place: PurePosixPath, new: bytes, why: str) -> None:
    beside = place.with_name(f"{place.stem}.new{place.suffix}")
    if _content(folder / beside) != new:
        made.writes[beside] = new
    made.tell(place, f"{why}; the new one is next to it: {beside.name}")


def _content(file: Path) -> bytes | None:
    try:
        return file.read_bytes()
    except OSError:
        return None


BACKUPS = "backups"


def carry_out(plan: Plan, folder: Path) -> Path | None:
    """Write everything. Returns the folder with a copy of each file that is replaced, None where none is.

    If it breaks off, the same update can be done again: what was handed out is remembered last. Raises `OSError`.
    """
    replaced = [place for place in plan.writes if (folder / place).exists()]
    backup = _new_backup(folder) if replaced else None
    for place in replaced:
        assert backup
        (backup / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(folder / place, backup / place)
    for place, data in (*plan.writes.items(), *plan.base.items()):
        write_if_changed(folder / place, data)
    for place in plan.forgotten:
        (folder / place).unlink(missing_ok=True)
    return backup


def _new_backup(folder: Path) -> Path:
    stamp = datetime.now().strftime("%Y-%m-%d-%H%M%S")
    number = 1
    while True:
        backup = folder / BACKUPS / (stamp if number == 1 else f"{stamp}-{number}")
        try:
            backup.mkdir(parents=True)
            return backup
        except FileExistsError:
            number += 1
