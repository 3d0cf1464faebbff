"""Puts a chapter's prose and fences in order as cells, with ids that stay and can be read."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from spinbook.chapter.chapter import Cell, CellKind
from spinbook.chapter.classify import Classified, FenceKind
from spinbook.chapter.terminal import CommandKind
from spinbook.course.block import Kind, Line
from spinbook.course.layout import Piece

#: nbformat allows 64 characters of [A-Za-z0-9_-].
_LONGEST_ID = 64
_KINDS = {
    FenceKind.NODE: CellKind.NODE,
    FenceKind.PART: CellKind.PART,
    FenceKind.SNIPPET: CellKind.SNIPPET,
    FenceKind.SHELL: CellKind.SHELL,
    FenceKind.INTERFACE: CellKind.INTERFACE,
    FenceKind.FILE: CellKind.FILE,
}


def make_cells(pieces: Iterable[Piece], classified: dict[int, Classified]) -> tuple[Cell, ...]:
    """The cells of a chapter. `classified` are its fences by their line."""
    ids = _Ids()
    cells: list[Cell] = []
    lines: list[Piece] = []
    for piece in pieces:
        if piece.heading or piece.block is not None:
            cells.extend(_prose(lines, ids))
            lines = []
        if piece.block is None:
            lines.append(piece)
        elif piece.block.kind is Kind.EXERCISE:
            name = piece.block.title
            cells.append(Cell(CellKind.EXERCISE, ids.named(f"exercise-{name}"), "", piece.block.line, name=name))
        elif piece.block.fence is not None:
            cells.append(_runnable(classified[piece.block.fence.line], ids))
    cells.extend(_prose(lines, ids))
    return tuple(cells)


def _prose(pieces: list[Piece], ids: _Ids) -> Iterator[Cell]:
    """A piece of prose without the empty lines around it, which begins with the section's heading if it has one."""
    lines = [piece.line for piece in pieces if piece.line is not None]
    while lines and not lines[0].text.strip():
        lines.pop(0)
    while lines and not lines[-1].text.strip():
        lines.pop()
    if lines:
        heading = next((piece.line for piece in pieces if piece.heading), None)
        text = "\n".join(line.text for line in lines)
        yield Cell(CellKind.PROSE, ids.prose(heading), text, lines[0].number)


def _runnable(item: Classified, ids: _Ids) -> Cell:
    fence = item.fence
    return Cell(
        _KINDS[item.kind],
        _id(item, ids),
        fence.code,
        fence.first_code_line,
        name=item.name,
        seconds=float(fence.attributes["seconds"]) if "seconds" in fence.attributes else None,
        until=fence.attributes.get("until"),
        raises=fence.has("raises"),
        spin_classes=item.spin_classes,
        runs_main=item.runs_main,
        before=item.before,
        after=item.after,
        runs_in_kernel=item.runs_in_kernel,
        executables=item.executables,
        commands=item.commands,
    )


def _id(item: Classified, ids: _Ids) -> str:
    if item.kind is FenceKind.NODE:
        return ids.named(f"node-{item.name}")
    if item.kind is FenceKind.PART:
        return ids.named(f"part-{item.name}")
    if item.kind is FenceKind.INTERFACE:
        return ids.named(f"interface-{(item.name or '').rpartition('/')[2]}")
    if item.kind is FenceKind.FILE:
        return ids.named(f"file-{(item.name or '').rpartition('/')[2]}")
    if item.kind is FenceKind.SHELL:
        return ids.named(next(command for command in item.commands if command.kind is not CommandKind.NOTE).text)
    return ids.snippet()


class _Ids:
    """Names cells for what they hold, and counts where two would have one name."""

    def __init__(self) -> None:
        self._section = "start"
        self._given: dict[str, int] = {}

    def prose(self, heading: Line | None) -> str:
        if heading is not None:
            self._section = _slug(heading.text.strip().strip("#")) or "section"
        return self.named(self._section)

    def snippet(self) -> str:
        return self.named(f"code-{self._section}")

    def named(self, text: str) -> str:
        base = _slug(text)[: _LONGEST_ID - 4].strip("-") or "cell"
        name = base
        while name in self._given:
            self._given[base] += 1
            name = f"{base}-{self._given[base]}"
        self._given[name] = 1
        return name


def _slug(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower().replace("_", "-")).strip("-")
