"""Notebooks for tests of updates, as a handout has them and as students leave them."""

from __future__ import annotations

import json
from typing import Any

Cell = dict[str, Any]


def cell(text: str, id: str | None, kind: str = "code", **known: Any) -> Cell:
    """Return a cell with this text; `known` is what our tools note about it."""
    made: Cell = {"cell_type": kind, "metadata": {"spinbook": known} if known else {}, "source": text}
    if id is not None:
        made["id"] = id
    if kind == "code":
        made |= {"outputs": [], "execution_count": None}
    return made


def ran(made: Cell, output: str) -> Cell:
    """Return the cell as it is after it was run."""
    return {**made, "outputs": [{"output_type": "stream", "name": "stdout", "text": [output]}], "execution_count": 3}


def notebook(*cells: Cell, chapter: str = "chapters/01.md", indent: int = 1) -> bytes:
    """Return a notebook of these cells."""
    metadata = {"spinbook": {"chapter": chapter}, "title": "A chapter"}
    content = {"cells": list(cells), "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}
    return (json.dumps(content, ensure_ascii=False, indent=indent) + "\n").encode()


def cells_of(data: bytes) -> list[Cell]:
    """Return the cells of a notebook."""
    cells: list[Cell] = json.loads(data)["cells"]
    return cells


def texts(data: bytes) -> list[str]:
    """Return the text of each cell."""
    return ["".join(cell["source"]) for cell in cells_of(data)]
