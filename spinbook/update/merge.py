"""Merges an author's changes into a student's cells. What the student wrote always stays."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from typing import Any

Cell = dict[str, Any]

#: Cells that are at least this similar count as one cell that was edited. Between 0 and 1.
ALIKE = 0.7
#: Only this many characters of a cell are compared to find out how similar two cells are.
_COMPARED = 4000

_NODE = re.compile(r"%%node\s+(\w+)")


def text(cell: Cell) -> str:
    """Return the content of a cell, without line ends and final space, in which editors differ."""
    source = cell.get("source", "")
    joined = source if isinstance(source, str) else "".join(source)
    return joined.replace("\r\n", "\n").rstrip()


def content(cell: Cell) -> tuple[str, str]:
    """Return what has to be equal in equal cells: type and text, not outputs."""
    return cell.get("cell_type", ""), text(cell)


def label(cell: Cell) -> str:
    """Return a cell's name for people: its first line."""
    lines = [line.strip() for line in text(cell).split("\n") if line.strip()]
    return (lines[0] if lines else "an empty cell")[:60]


def found_again(old: Sequence[Cell], new: Sequence[Cell]) -> dict[int, int]:
    """Map the indices of cells in `old` to those in `new`: by id, by content, by node, or by similarity."""
    partners: dict[int, int] = {}
    # If two cells have the same id, the one with the old content comes first.
    _pair(old, new, partners, lambda cell: (cell.get("id"), content(cell)) if cell.get("id") else None)
    _pair(old, new, partners, lambda cell: cell.get("id"))
    _pair(old, new, partners, lambda cell: content(cell) if text(cell) else None)
    _pair(old, new, partners, _node)
    _pair_alike(old, new, partners)
    return partners


def _pair(old: Sequence[Cell], new: Sequence[Cell], partners: dict[int, int], key: Any) -> None:
    """Pair cells without a partner that have the same key; if several have it, in their order."""
    waiting: dict[Any, list[int]] = {}
    taken = set(partners.values())
    for j, cell in enumerate(new):
        if j not in taken:
            waiting.setdefault(key(cell), []).append(j)
    waiting.pop(None, None)
    for i, cell in enumerate(old):
        if i not in partners and (there := waiting.get(key(cell))):
            partners[i] = there.pop(0)


def _node(cell: Cell) -> tuple[str, str] | None:
    """Return the exercise or the node to which a cell belongs."""
    if cell.get("cell_type") != "code":
        return None
    known = cell.get("metadata", {}).get("spinbook", {})
    if isinstance(known, dict) and isinstance(known.get("exercise"), str):
        return "exercise", known["exercise"]
    match = _NODE.match(text(cell))
    return ("node", match.group(1)) if match else None


def _pair_alike(old: Sequence[Cell], new: Sequence[Cell], partners: dict[int, int]) -> None:
    taken = set(partners.values())
    rest = [(i, text(cell)[:_COMPARED]) for i, cell in enumerate(old) if i not in partners and text(cell)]
    there = [(j, text(cell)[:_COMPARED]) for j, cell in enumerate(new) if j not in taken and text(cell)]
    pairs = []
    for j, theirs in there:
        matcher = SequenceMatcher(b=theirs, autojunk=False)
        for i, ours in rest:
            matcher.set_seq1(ours)
            if matcher.real_quick_ratio() >= ALIKE and matcher.quick_ratio() >= ALIKE:
                pairs.append((-matcher.ratio(), i, j))
    for unlike, i, j in sorted(pairs):
        if -unlike >= ALIKE and i not in partners and j not in taken:
            partners[i] = j
            taken.add(j)


# There are three sides: `base` was handed out; `mine` is what the student made of it; `new` is what is handed out
# now. A cell that only one of the two changed is taken from that one. Where both did, the student's is kept and the
# new one is shown below it, as text: were it code, it could be taken for the student's.


@dataclass
class MergeReport:
    """What happened to cells, by their labels, as a report for the student."""

    taken: list[str] = field(default_factory=list)
    added: list[str] = field(default_factory=list)
    removed: list[str] = field(default_factory=list)
    conflicts: list[str] = field(default_factory=list)
    kept_though_removed: list[str] = field(default_factory=list)
    back: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    order_kept: bool = False


@dataclass(frozen=True)
class _Item:
    """One cell of the result: its index in `mine` and in `new`, and the cells below it."""

    mine: int | None
    new: int | None
    cell: Cell
    below: tuple[Cell, ...] = ()


def merged(base: Sequence[Cell], mine: Sequence[Cell], new: Sequence[Cell]) -> tuple[list[Cell], MergeReport]:
    """Return the student's cells with the author's changes, and a report.

    With `new` equal to `base` the result equals `mine`. Every cell of `mine` that differs from its `base`, or has none,
    is in the result.
    """
    merge = _Merge(base, mine, new, found_again(base, mine), found_again(base, new))
    return merge.cells(), merge.report


def merged_without_base(mine: Sequence[Cell], new: Sequence[Cell]) -> tuple[list[Cell], MergeReport]:
    """Merge without the original handout: a cell that differs counts as changed by both."""
    pairs = sorted(found_again(new, mine).items())
    unknown: Cell = {"cell_type": "", "source": ""}
    base = [new[j] if content(new[j]) == content(mine[i]) else unknown for j, i in pairs]
    merge = _Merge(base, mine, new, {b: i for b, (_, i) in enumerate(pairs)}, {b: j for b, (j, _) in enumerate(pairs)})
    return merge.cells(), merge.report


class _Merge:
    """One merge. `mine_of` and `new_of` map the index of a cell in the base to its index now."""

    def __init__(
        self,
        base: Sequence[Cell],
        mine: Sequence[Cell],
        new: Sequence[Cell],
        mine_of: dict[int, int],
        new_of: dict[int, int],
    ) -> None:
        self.base, self.mine, self.new = base, mine, new
        self.mine_of, self.new_of = mine_of, new_of
        self.report = MergeReport()

    def cells(self) -> list[Cell]:
        items = [*self._on_both_sides(), *self._only_mine()]
        items += self._only_new({item.new for item in items})
        in_mine = sorted((item for item in items if item.mine is not None), key=lambda item: item.mine or 0)
        in_new = sorted((item for item in items if item.new is not None), key=lambda item: item.new or 0)
        if self._moved(self.mine_of):
            self.report.order_kept = self._moved(self.new_of)
            order = _woven(in_mine, in_new)
        else:
            order = _woven(in_new, in_mine)
        return [cell for item in order for cell in (item.cell, *item.below)]

    def _on_both_sides(self) -> list[_Item]:
        there = {content(cell) for cell in self.mine}
        items = []
        for b, i in self.mine_of.items():
            if b in self.new_of:
                j = self.new_of[b]
                cell, below = self._merged_cell(self.base[b], self.mine[i], self.new[j])
                items.append(_Item(i, j, cell, tuple(shown for shown in below if content(shown) not in there)))
        return items

    def _merged_cell(self, base: Cell, mine: Cell, new: Cell) -> tuple[Cell, tuple[Cell, ...]]:
        if content(mine) == content(new) or content(new) == content(base):
            return _refreshed(mine, base, new), ()
        if content(mine) == content(base):
            self.report.taken.append(label(new))
            return new, ()
        self.report.conflicts.append(label(mine))
        return _refreshed(mine, base, new), (shown_below(new),)

    def _only_mine(self) -> list[_Item]:
        """Return the cells that the student added, and those that the author removed but the student changed."""
        base_of = {i: b for b, i in self.mine_of.items()}
        added = [j for j in range(len(self.new)) if j not in self.new_of.values()]
        items = []
        for i, cell in enumerate(self.mine):
            b = base_of.get(i)
            if b is None:
                # The same cell may be new on both sides, for example after an interrupted update.
                same = next((j for j in added if content(self.new[j]) == content(cell) and text(cell)), None)
                added = [j for j in added if j != same]
                items.append(_Item(i, same, cell))
            elif b not in self.new_of and content(cell) == content(self.base[b]):
                self.report.removed.append(label(cell))
            elif b not in self.new_of:
                self.report.kept_though_removed.append(label(cell))
                items.append(_Item(i, None, cell))
        return items

    def _only_new(self, have: set[int | None]) -> list[_Item]:
        """Return the cells that the author added, and those that the student deleted but the author changed."""
        base_of = {j: b for b, j in self.new_of.items()}
        items = []
        for j, cell in enumerate(self.new):
            if j in have:
                continue
            if j not in base_of:
                self.report.added.append(label(cell))
                items.append(_Item(None, j, cell))
            elif content(cell) != content(self.base[base_of[j]]):
                self.report.back.append(label(cell))
                items.append(_Item(None, j, cell))
            elif _is_needed(cell):
                self.report.missing.append(label(cell))
        return items

    def _moved(self, of: dict[int, int]) -> bool:
        """Return whether the cells that both sides have are in a different order than in the base."""
        places = [of[b] for b in range(len(self.base)) if b in self.mine_of and b in self.new_of]
        return places != sorted(places)


def _is_needed(cell: Cell) -> bool:
    """Return whether an exercise can't be done without this cell, so that a missing one has to be reported."""
    known = cell.get("metadata", {}).get("spinbook", {})
    return bool(known.get("exercise")) or known.get("kind") in ("setup", "check")


def _refreshed(mine: Cell, base: Cell, new: Cell) -> Cell:
    """Return the student's cell unchanged, except for the new id and Spinbook's metadata."""
    if new.get("metadata") == base.get("metadata") and new.get("id") == base.get("id"):
        return mine
    cell = {**mine, "metadata": dict(mine.get("metadata", {}))}
    if "spinbook" in new.get("metadata", {}):
        cell["metadata"]["spinbook"] = new["metadata"]["spinbook"]
    if "id" in new:
        cell["id"] = new["id"]
    return cell


def shown_below(new: Cell) -> Cell:
    """Return the new version of a cell that the student has changed, as text."""
    language = "python" if new.get("cell_type") == "code" else "markdown"
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall(r"`+", text(new))), default=0))
    words = (
        "**CHANGED IN THE NEW HANDOUT.** You have changed the cell above, so yours is kept. This is the new version. "
        "Take over what you like, then delete this cell."
    )
    name = str(new.get("id", "cell"))[:60]
    source = f"{words}\n\n{fence}{language}\n{text(new)}\n{fence}"
    return {"cell_type": "markdown", "id": f"{name}-new", "metadata": {"spinbook": {"new": name}}, "source": source}


def _woven(first: Sequence[_Item], second: Sequence[_Item]) -> list[_Item]:
    """Return `first` in its order, with entries only in `second` inserted after those that they follow there."""
    order = list(first)
    before: _Item | None = None
    for item in second:
        if not any(item is there for there in order):
            at = next((k + 1 for k, there in enumerate(order) if there is before), 0)
            order.insert(at, item)
        before = item
    return order
