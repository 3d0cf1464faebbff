"""Finds the exercise's cell in a notebook."""

from __future__ import annotations

import json
import re
from typing import Any

from grader.exercise import Exercise


class NoCell(Exception):
    """Raised when a notebook holds no cell for the exercise; tells the student why."""


def cell_of(content: bytes, exercise: Exercise) -> str:
    """The code of the exercise's cell, with its lines numbered as in the cell: of several the last."""
    return cells_of(content, exercise)[-1]


def cells_of(content: bytes, exercise: Exercise) -> list[str]:
    """The code of every cell that is the exercise's, in their order; at least one. Lines of magic become empty ones.

    Those are cells whose metadata says `spinbook.exercise`, else those with `%%node` and the exercise's name, else
    those that define the exercise's class, else those that make its node. Raises `NoCell`.
    """
    try:
        cells = json.loads(content)["cells"]
        codes = [(_exercise(cell), _source(cell)) for cell in cells if cell.get("cell_type") == "code"]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise NoCell(f"It is no notebook that can be read: {type(error).__name__}: {error}.") from None
    stem = exercise.file_name.removesuffix(".py")
    magic = re.compile(rf"^%%node\s+{re.escape(stem)}(\.py)?(\s.*)?$", re.MULTILINE)
    definition = re.compile(rf"^class\s+{re.escape(exercise.class_name)}\b", re.MULTILINE)
    node = re.compile(rf"""(Node|__init__|create_node)\(\s*['"]{re.escape(exercise.node_name)}['"]""")
    for found in (
        [code for name, code in codes if name == exercise.name],
        [code for _, code in codes if magic.search(code)],
        [code for _, code in codes if exercise.class_name and definition.search(code)],
        [code for _, code in codes if node.search(code)],
    ):
        if found:
            return [_without_magic(code) for code in found]
    what = f"class {exercise.class_name}" if exercise.class_name else f"node {exercise.node_name}"
    raise NoCell(
        f"None of the notebook's {len(codes)} code cells is the exercise's. Write the {what} in the cell that the "
        f"chapter gives for it; it begins with %%node {stem}."
    )


def _exercise(cell: dict[str, Any]) -> str:
    spinbook = cell.get("metadata", {}).get("spinbook", {})
    name = spinbook.get("exercise", "") if isinstance(spinbook, dict) else ""
    return name if isinstance(name, str) else ""


def _source(cell: dict[str, Any]) -> str:
    source = cell.get("source", "")
    return source if isinstance(source, str) else "".join(source)


def _without_magic(code: str) -> str:
    return "\n".join("" if line.startswith(("%", "!")) else line for line in code.split("\n"))
