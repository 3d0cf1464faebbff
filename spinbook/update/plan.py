"""Plans an update before anything is changed, and carries it out: first a backup, then every file."""

from __future__ import annotations

import copy
import hashlib
import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import Any

from groundwork.files import write_if_changed
from spinbook.update.handout import BASE, Files, is_remembered
from spinbook.update.merge import Cell, MergeReport, content, merged, merged_without_base


class NoNotebook(Exception):
    """Raised for a file that is not a readable notebook; says why."""


def read(data: bytes) -> dict[str, Any]:
    """Return a notebook as a dictionary, with at least `cells` and `metadata`. Raises `NoNotebook`."""
    try:
        notebook = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise NoNotebook(f"{type(error).__name__}: {error}") from None
    cells = notebook.get("cells") if isinstance(notebook, dict) else None
    if not isinstance(cells, list) or not all(_is_cell(cell) for cell in cells):
        raise NoNotebook("it has no list of cells, as notebooks since 2015 have")
    if not isinstance(notebook.setdefault("metadata", {}), dict):
        raise NoNotebook("its metadata is not a dictionary")
    assert isinstance(notebook, dict)
    return notebook


def _is_cell(cell: Any) -> bool:
    if not isinstance(cell, dict) or not isinstance(cell.get("cell_type"), str):
        return False
    known = cell.get("metadata", {})
    source = cell.get("source", "")
    texts = source if isinstance(source, list) else [source]
    return (
        isinstance(known, dict)
        and isinstance(known.get("spinbook", {}), dict)
        and all(isinstance(part, str) for part in texts)
    )


def chapter(notebook: dict[str, Any]) -> str:
    """Return the chapter of a notebook, under whatever name it is saved; "" if it is not a chapter's."""
    known = notebook["metadata"].get("spinbook", {})
    name = known.get("chapter", "") if isinstance(known, dict) else ""
    return name if isinstance(name, str) else ""


def merged_notebook(base: bytes | None, mine: bytes, new: bytes) -> tuple[bytes, MergeReport]:
    """Return the student's notebook with the author's changes in it. Raises `NoNotebook` if one of them is not a
    notebook.

    With no `base` (a handout that kept none) a cell counts as the student's if it differs from the new one.
    """
    ours, theirs = read(mine), read(new)
    if base == new:
        return mine, MergeReport()
    if base is None:
        result, text = merged_without_base(ours["cells"], theirs["cells"])
    else:
        result, text = merged(read(base)["cells"], ours["cells"], theirs["cells"])
    notebook = copy.deepcopy(ours)
    notebook["cells"] = _with_ids_of_their_own(copy.deepcopy(result))
    for key in ("spinbook", "title"):
        if key in theirs["metadata"]:
            notebook["metadata"][key] = theirs["metadata"][key]
    # Cells have ids since nbformat 4.5.
    if (notebook.get("nbformat"), notebook.get("nbformat_minor", 0)) < (4, 5):
        notebook["nbformat"], notebook["nbformat_minor"] = 4, 5
    if notebook == ours:
        return mine, text
    return (json.dumps(notebook, ensure_ascii=False, indent=1) + "\n").encode(), text


def _with_ids_of_their_own(cells: list[Cell]) -> list[Cell]:
    """Give each cell without an id, or with the id of another, a new one that depends only on the cells."""
    seen: set[str] = set()
    for number, cell in enumerate(cells):
        name = cell.get("id")
        while not isinstance(name, str) or not name or name in seen:
            name = hashlib.sha256(f"{name} {number} {content(cell)}".encode()).hexdigest()[:16]
        cell["id"] = name
        seen.add(name)
    return cells


#: Folders that are not searched for a student's notebook.
_NOT_LOOKED_IN = {".spinbook", ".ipynb_checkpoints", ".venv", "backups", "build"}


@dataclass
class UpdatePlan:
    """Files to write, what to report about each, and entries of the base that are out of date.

    `report` has one or more lines per file, by the file's path; `notebooks` has the reports of merges.
    """

    writes: Files = field(default_factory=dict)
    report: dict[PurePosixPath, list[str]] = field(default_factory=dict)
    notebooks: dict[PurePosixPath, MergeReport] = field(default_factory=dict)
    base: Files = field(default_factory=dict)
    forgotten: list[PurePosixPath] = field(default_factory=list)

    def add(self, path: PurePosixPath, line: str) -> None:
        """Add a line for the student about one file."""
        self.report.setdefault(path, []).append(line)


def plan(folder: Path, handout: Mapping[PurePosixPath, bytes]) -> UpdatePlan:
    """Plan what updates the student's `folder` to `handout`. Nothing is changed."""
    made = UpdatePlan()
    base = _base_in(folder)
    for path, data in sorted(handout.items()):
        if path.parts[0] == ".spinbook":
            if not path.is_relative_to(BASE):
                _own(made, folder, path, data)
            continue
        if path.suffix == ".ipynb":
            _notebook(made, folder, path, base.get(path), data)
        else:
            _file(made, folder, path, base.get(path), data)
        if is_remembered(path) and base.get(path) != data:
            made.base[BASE / path] = data
    for path in sorted(set(base) - set(handout)):
        made.forgotten.append(BASE / path)
        if (folder / path).exists():
            made.add(path, "is no longer part of the handout. Yours stays.")
    return made


def _base_in(folder: Path) -> Files:
    root = folder / BASE
    return {
        PurePosixPath(path.relative_to(root).as_posix()): path.read_bytes()
        for path in sorted(root.rglob("*"))
        if path.is_file()
    }


def _own(made: UpdatePlan, folder: Path, path: PurePosixPath, data: bytes) -> None:
    """Plan to write a file of Spinbook's own, which students do not edit."""
    if _content(folder / path) != data:
        made.base[path] = data


def _file(made: UpdatePlan, folder: Path, path: PurePosixPath, base: bytes | None, new: bytes) -> None:
    mine = _content(folder / path)
    if mine == new or new == base:
        return
    if mine is None:
        made.writes[path] = new
        made.add(path, "is new." if base is None else "was deleted here and has changed in the handout: it is back.")
    elif mine == base or not is_remembered(path) or (base is None and path.suffix != ".py"):
        made.writes[path] = new
        made.add(path, "has changed in the handout: the new one is taken.")
    else:
        _beside(made, folder, path, new, "You have changed it and so has the handout. Yours is kept")


def _notebook(made: UpdatePlan, folder: Path, path: PurePosixPath, base: bytes | None, new: bytes) -> None:
    if new == base:
        return
    where = _students(folder, path, new)
    mine = _content(folder / where)
    if mine is None:
        made.writes[path] = new
        made.add(path, "is new." if base is None else "was deleted here and has changed in the handout: it is back.")
        return
    if mine in (base, new):
        if mine != new:
            made.writes[where] = new
            made.add(where, "has changed in the handout, and not here: the new one is taken.")
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


def _students(folder: Path, path: PurePosixPath, new: bytes) -> PurePosixPath:
    """Return the path of this notebook in the student's folder, where it may have another name."""
    if (folder / path).exists():
        return path
    try:
        name = chapter(read(new))
    except NoNotebook:
        return path
    notebooks = []
    for file in sorted(folder.rglob("*.ipynb")):
        where = PurePosixPath(file.relative_to(folder).as_posix())
        if name and not _NOT_LOOKED_IN & set(where.parts) and _chapter_of(file) == name:
            notebooks.append(where)
    return notebooks[0] if len(notebooks) == 1 else path


def _chapter_of(path: Path) -> str:
    try:
        return chapter(read(path.read_bytes()))
    except (OSError, NoNotebook):
        return ""


def _beside(made: UpdatePlan, folder: Path, path: PurePosixPath, new: bytes, why: str) -> None:
    beside = path.with_name(f"{path.stem}.new{path.suffix}")
    if _content(folder / beside) != new:
        made.writes[beside] = new
    made.add(path, f"{why}; the new one is next to it: {beside.name}")


def _content(file: Path) -> bytes | None:
    try:
        return file.read_bytes()
    except OSError:
        return None


BACKUPS = "backups"


def carry_out(plan: UpdatePlan, folder: Path) -> Path | None:
    """Carry out a plan. Return the folder with copies of the replaced files, or None if no file is replaced.

    If it is interrupted, the same update can be repeated, because the original files are written last. Raises
    `OSError`.
    """
    replaced = [path for path in plan.writes if (folder / path).exists()]
    backup = _new_backup(folder) if replaced else None
    for path in replaced:
        assert backup
        (backup / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(folder / path, backup / path)
    for path, data in (*plan.writes.items(), *plan.base.items()):
        write_if_changed(folder / path, data)
    for path in plan.forgotten:
        (folder / path).unlink(missing_ok=True)
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
