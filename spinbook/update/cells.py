"""A notebook's cells, as plain dictionaries, and when two are the same."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import SequenceMatcher
from typing import Any

Cell = dict[str, Any]

#: Cells at least this alike are taken for one cell that was edited. Between 0 and 1.
ALIKE = 0.7
#: More of a cell than this (characters) is not looked at to find out how alike two are.
_COMPARED = 4000

_NODE = re.compile(r"%%node\s+(\w+)")


def text(cell: Cell) -> str:
    """What stands in a cell. Editors differ in line ends and in space at the end; those don't count."""
    source = cell.get("source", "")
    joined = source if isinstance(source, str) else "".join(source)
    return joined.replace("\r\n", "\n").rstrip()


def content(cell: Cell) -> tuple[str, str]:
    """What makes a cell the same as another: its type and its text, not its outputs."""
    return cell.get("cell_type", ""), text(cell)


def label(cell: Cell) -> str:
    """A cell's name for people: its node, or its first line."""
    lines = [line.strip() for line in text(cell).split("\n") if line.strip()]
    return (lines[0] if lines else "an empty cell")[:60]


def found_again(old: Sequence[Cell], new: Sequence[Cell]) -> dict[int, int]:
    """For cells of `old`, by their index, where they are in `new`: by id, by content, as a node, or as much alike."""
    found: dict[int, int] = {}
    # Of two cells with one id the one with the old content is meant.
    _pair(old, new, found, lambda cell: (cell.get("id"), content(cell)) if cell.get("id") else None)
    _pair(old, new, found, lambda cell: cell.get("id"))
    _pair(old, new, found, lambda cell: content(cell) if text(cell) else None)
    _pair(old, new, found, _node)
    _pair_alike(old, new, found)
    return found


def _pair(old: Sequence[Cell], new: Sequence[Cell], found: dict[int, int], key: Any) -> None:
    """Pair cells that have no partner yet and one key; where several have it, in their order."""
    waiting: dict[Any, list[int]] = {}
    taken = set(found.values())
    for j, cell in enumerate(new):
        if j not in taken:
            waiting.setdefault(key(cell), []).append(j)
    waiting.pop(None, None)
    for i, cell in enumerate(old):
        if i not in found and (there := waiting.get(key(cell))):
            found[i] = there.pop(0)


def _node(cell: Cell) -> tuple[str, str] | None:
    """The exercise or the node whose cell this is."""
    if cell.get("cell_type") != "code":
        return None
    known = cell.get("metadata", {}).get("spinbook", {})
    if isinstance(known, dict) and isinstance(known.get("exercise"), str):
        return "exercise", known["exercise"]
    match = _NODE.match(text(cell))
    return ("node", match.group(1)) if match else None


def _pair_alike(old: Sequence[Cell], new: Sequence[Cell], found: dict[int, int]) -> None:
    taken = set(found.values())
    rest = [(i, text(cell)[:_COMPARED]) for i, cell in enumerate(old) if i not in found and text(cell)]
    there = [(j, text(cell)[:_COMPARED]) for j, cell in enumerate(new) if j not in taken and text(cell)]
    pairs = []
    for j, theirs in there:
        matcher = SequenceMatcher(b=theirs, autojunk=False)
        for i, ours in rest:
            matcher.set_seq1(ours)
            if matcher.real_quick_ratio() >= ALIKE and matcher.quick_ratio() >= ALIKE:
                pairs.append((-matcher.ratio(), i, j))
    for unlike, i, j in sorted(pairs):
        if -unlike >= ALIKE and i not in found and j not in taken:
            found[i] = j
            taken.add(j)
