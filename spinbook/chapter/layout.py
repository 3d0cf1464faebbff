"""Puts a chapter's blocks in sequence: cells move to the left margin, the rest becomes Markdown for every tool.

Admonitions become MyST's `:::{note}`, tabs and folded text `<details>`, and a container with a cell is split around the
cell. Text that needs no change stays as it is, to the byte.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from spinbook.chapter.attributes import STYLES
from spinbook.chapter.block import Block, BlockKind, SourceLine

if TYPE_CHECKING:
    from spinbook.chapter.classify import ClassifiedFence

_RESHAPED = frozenset({BlockKind.ADMONITION, BlockKind.TAB, BlockKind.GROUP})


@dataclass(frozen=True)
class Piece:
    """A line of prose, or a block that becomes a cell. `heading` says that a section begins with this line."""

    line: SourceLine | None = None
    block: Block | None = None
    heading: bool = False

    @property
    def is_blank(self) -> bool:
        """Whether it is an empty line."""
        return self.line is not None and not self.line.text.strip()


@dataclass(frozen=True)
class ChapterLayout:
    """How blocks are laid out. `fences` are what fences become, by their lines; `exercises` are those that exist."""

    fences: Mapping[int, ClassifiedFence]
    exercises: Collection[str]

    def pieces(self, blocks: Sequence[Block]) -> list[Piece]:
        """Return the chapter's pieces, in order."""
        out: list[Piece] = []
        for block in blocks:
            if block.kind is BlockKind.HEADING:
                first, *rest = block.lines
                out += [Piece(first, heading=True), *_lines(rest)]
            else:
                out += self._block(block)
        return out

    def _classified(self, block: Block) -> ClassifiedFence | None:
        return self.fences[block.fence.line] if block.kind is BlockKind.FENCE and block.fence is not None else None

    def _sign(self, block: Block) -> str:
        """Return the note below a fence that is not run; "" if readers need none."""
        item = self._classified(block)
        return f"<small>Not run here: {item.sign}</small>" if item and item.sign else ""

    def _becomes_cell(self, block: Block) -> bool:
        item = self._classified(block)
        is_exercise = block.kind is BlockKind.EXERCISE and block.title in self.exercises
        return is_exercise or (item is not None and not item.is_static)

    def _holds_cell(self, block: Block) -> bool:
        return any(self._becomes_cell(inner) for inner in block.walk())

    def _is_changed(self, block: Block) -> bool:
        return any(
            inner.new is not None
            or inner.kind in _RESHAPED
            or inner.kind is BlockKind.DROPPED
            or (inner.kind is BlockKind.DETAILS and not inner.lines[0].text.lstrip().startswith("<details"))
            or bool(self._sign(inner))
            for inner in block.walk()
        )

    def _block(self, block: Block) -> list[Piece]:
        if self._becomes_cell(block):
            item = self._classified(block)
            return [Piece(block=block), *_printed(item.output if item else "", block)]
        if not self._is_changed(block) and not self._holds_cell(block):
            return _lines(block.lines)
        lay_out = getattr(self, f"_{block.kind.value}", None)
        return lay_out(block) if lay_out else _written(block)

    def _children(self, blocks: Iterable[Block]) -> list[Piece]:
        out: list[Piece] = []
        before: Block | None = None
        for block in blocks:
            if block.kind is BlockKind.TAB and not self._holds_cell(block):
                out += self._folded(block, is_open=before is None or before.kind is not BlockKind.TAB)
            else:
                out += self._block(block)
            before = block if any(line.text.strip() for line in block.lines) else before
        return out

    # A method `_KIND` lays out the blocks of that kind.

    def _dropped(self, block: Block) -> list[Piece]:
        return [] if block.style else _lines(block.new or ())

    def _fence(self, block: Block) -> list[Piece]:
        sign, number = self._sign(block), block.lines[-1].number
        note = [SourceLine(text, number) for text in ("", sign, "")] if sign else []
        return [*_written(block), *_lines(note)]

    def _admonition(self, block: Block) -> list[Piece]:
        style = block.style if block.style in STYLES else "note"
        colons = ":" * (3 + _height(block))
        opening = (
            [f"{colons}{{admonition}} {block.title}", f":class: {style}"] if block.title else [f"{colons}{{{style}}}"]
        )
        inside = self._children(block.children)
        first = next((piece for piece in inside if not piece.is_blank), None)
        # A box that begins with a cell has no text to be around; its title stays.
        title = _bold(block) if first is not None and first.block is not None else []
        return [*title, *_wrapped(inside, opening, [colons], block)]

    def _tab(self, block: Block) -> list[Piece]:
        return self._group(block) if self._holds_cell(block) else self._folded(block, is_open=True)

    def _details(self, block: Block) -> list[Piece]:
        return self._group(block) if self._holds_cell(block) else self._folded(block, is_open=False)

    def _group(self, block: Block) -> list[Piece]:
        return _spaced([*_bold(block), *self._children(block.children)], block)

    def _folded(self, block: Block, *, is_open: bool) -> list[Piece]:
        title = block.title or block.style.capitalize()
        opening = [f"<details{' open' if is_open else ''}>", f"<summary>{title}</summary>", ""]
        inside = self._children(block.children)
        return _spaced(_wrapped(inside, opening, ["", "</details>"], block), block)

    def _quote(self, block: Block) -> list[Piece]:
        return [_changed(piece, lambda text: f"> {text}".rstrip()) for piece in self._children(block.children)]

    def _list(self, block: Block) -> list[Piece]:
        out: list[Piece] = []
        cut = self._holds_cell(block)
        for index, item in enumerate(block.children):
            marker = item.lines[0].text[: item.offset]
            if cut and item.title.isdigit():
                # A list that is cut continues its numbers.
                number = int(block.children[0].title) + index
                marker = marker.replace(item.title, str(number), 1)
            out += _item(self._children(item.children), marker, item)
        return out


def _item(pieces: list[Piece], marker: str, item: Block) -> list[Piece]:
    """Indent an item's lines below its marker, up to its first cell; what follows a cell goes to the margin."""
    out: list[Piece] = []
    first, in_item = True, True
    for piece in pieces:
        if piece.block is not None:
            if first:
                out.append(Piece(SourceLine(marker.rstrip(), item.line)))
            out += [Piece(SourceLine("", item.line)), piece, Piece(SourceLine("", item.line))]
            in_item = first = False
        elif in_item and not (first and piece.is_blank):
            out.append(_prefixed(piece, marker if first else " " * item.offset))
            first = False
        elif not in_item:
            out.append(piece)
    return out if out else [Piece(SourceLine(marker.rstrip(), item.line))]


def _printed(output: str, block: Block) -> list[Piece]:
    """Return what the author's terminal printed, as text below the cell that runs the commands."""
    if not output:
        return []
    number = block.lines[-1].number
    texts = ["", "In the author's terminal:", "", "````text", *output.split("\n"), "````", ""]
    return _lines(SourceLine(text, number) for text in texts)


def _bold(block: Block) -> list[Piece]:
    """Return the title of a block as a paragraph; nothing if it has none."""
    lines = [SourceLine(f"**{block.title}**", block.line), SourceLine("", block.line)]
    return _lines(lines) if block.title else []


def _lines(lines: Iterable[SourceLine]) -> list[Piece]:
    return [Piece(line) for line in lines]


def _written(block: Block) -> list[Piece]:
    """Return a block's lines: the new ones if Markdown tools would not understand the author's."""
    return _lines(block.lines if block.new is None else block.new)


def without_blanks_around(pieces: Sequence[Piece]) -> list[Piece]:
    """Return the pieces without the empty lines before the first and after the last that is not empty."""
    shown = [at for at, piece in enumerate(pieces) if not piece.is_blank]
    return list(pieces[shown[0] : shown[-1] + 1]) if shown else []


def _prefixed(piece: Piece, prefix: str) -> Piece:
    return _changed(piece, lambda text: f"{prefix}{text}".rstrip() if text else "")


def _changed(piece: Piece, change: Callable[[str], str]) -> Piece:
    return piece if piece.line is None else Piece(SourceLine(change(piece.line.text), piece.line.number))


def _height(block: Block) -> int:
    inner = [_height(child) + (child.kind is BlockKind.ADMONITION) for child in block.children]
    return max(inner, default=0)


def _spaced(pieces: list[Piece], block: Block) -> list[Piece]:
    """Add an empty line before and after, so that what replaces a tag does not run into its neighbours."""
    if not pieces:
        return []
    before = [] if pieces[0].is_blank else _lines([SourceLine("", block.line)])
    behind = [] if pieces[-1].is_blank else _lines([SourceLine("", block.lines[-1].number)])
    return [*before, *pieces, *behind]


def _wrapped(pieces: list[Piece], opening: Sequence[str], closing: Sequence[str], block: Block) -> list[Piece]:
    """Put the opening and closing lines around the pieces, and again around the parts between cells."""
    out: list[Piece] = []
    for is_cell, part in itertools.groupby(pieces, lambda piece: piece.block is not None):
        if is_cell:
            out += part
        elif lines := without_blanks_around(list(part)):
            end = lines[-1].line.number if lines[-1].line else block.line
            before = _lines(SourceLine(text, block.line) for text in opening)
            out += [*before, *lines, *_lines(SourceLine(text, end) for text in (*closing, ""))]
    return out
