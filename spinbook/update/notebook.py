"""Merges a whole notebook, as text."""

from __future__ import annotations

import copy
import hashlib
import json
from typing import Any

from spinbook.update.merging import Cell, MergeReport, content, merged, merged_without_base


class NoNotebook(Exception):
    """Raised when a file is no notebook that can be read; says why."""


def read(data: bytes) -> dict[str, Any]:
    """A notebook as a dictionary, with at least `cells` and `metadata`. Raises `NoNotebook`."""
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
    """The chapter whose notebook this is, by whatever name it is saved; empty where it is another's."""
    known = notebook["metadata"].get("spinbook", {})
    name = known.get("chapter", "") if isinstance(known, dict) else ""
    return name if isinstance(name, str) else ""


def merged_notebook(base: bytes | None, mine: bytes, new: bytes) -> tuple[bytes, MergeReport]:
    """The student's notebook with the author's changes in it. Raises `NoNotebook` where one of them is none.

    With no `base` (a handout that kept none) a cell counts as the student's wherever it differs from the new one.
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
    """Cells without an id, or with one that another has, get a new one, which depends on nothing but the cells."""
    seen: set[str] = set()
    for number, cell in enumerate(cells):
        name = cell.get("id")
        while not isinstance(name, str) or not name or name in seen:
            name = hashlib.sha256(f"{name} {number} {content(cell)}".encode()).hexdigest()[:16]
        cell["id"] = name
        seen.add(name)
    return cells
