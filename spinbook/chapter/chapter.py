"""A chapter as data: its title and its cells in order, with ids that stay the same and can be read."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from spinbook.chapter.block import BlockKind, SourceLine
from spinbook.chapter.classify import CellKind, ClassifiedFence
from spinbook.chapter.layout import Piece, without_blanks_around
from spinbook.chapter.terminal import Command, CommandKind


@dataclass(frozen=True)
class ChapterCell:
    """One cell of a chapter. `line` is the chapter's line on which its source begins, counted from 1.

    `name` is a node's name (its file without .py), an exercise's, or an interface's, such as
    `my_interfaces/msg/Pose.msg`. `seconds` bounds how long it shows or runs (None: the runtime's default), `until` is a
    text in its log that ends that time early. `raises` says that failing is the lesson, `expects_error` that the node's
    errors are meant. `spin_classes` are the classes to spin where a node's code only defines them, `runs_main` says
    that its `main` has to be called. `before` is the code that completes a node, taken from the nodes and parts that
    `after` names; a part is code that later nodes use, and with `runs_in_kernel` a snippet as well. `keeps` says that a
    node is only saved, because it reads command-line arguments. `executables` are what `ros2 run` calls a node:
    (package, executable).
    """

    kind: CellKind
    id: str
    source: str
    line: int
    name: str | None = None
    seconds: float | None = None
    until: str | None = None
    raises: bool = False
    expects_error: bool = False
    replaces: str = ""
    """The node of which this is a newer version in another file; that one is stopped."""
    spin_classes: tuple[str, ...] = ()
    runs_main: bool = False
    before: str = ""
    after: tuple[str, ...] = ()
    runs_in_kernel: bool = True
    keeps: bool = False
    executables: tuple[tuple[str, str], ...] = ()
    commands: tuple[Command, ...] = ()
    shown_in: Path | None = None
    """The earlier chapter that shows this program, which a command of this one runs; None for a fence of its own."""
    tags: tuple[str, ...] = ()
    """Tags of Jupyter and MyST, such as `hide-input`."""

    @property
    def module(self) -> str:
        """The file name of a node's code."""
        return f"{self.name}.py"

    @property
    def whole(self) -> str:
        """A node's program as it runs, or a snippet with the usual imports that it lacks."""
        return self.before + self.source

    @property
    def shown(self) -> str:
        """The code as a cell shows it: a node's is completed when it runs, a snippet's in the cell."""
        completed = self.runs_in_kernel and self.kind in {CellKind.SNIPPET, CellKind.PART}
        return self.whole if completed else self.source


@dataclass(frozen=True)
class StaticFence:
    """A fence that is shown but not run, with the reason, for `spinbook lint`."""

    line: int
    language: str
    why: str
    sign: str = ""
    """The note for readers below it; "" if none is needed."""


@dataclass(frozen=True)
class Chapter:
    """A chapter that was read. `file` is as course.toml names it, relative to the course."""

    name: str
    file: Path
    title: str
    summary: str
    cells: tuple[ChapterCell, ...]
    static_fences: tuple[StaticFence, ...] = ()
    uses: tuple[Path, ...] = ()
    """The files of the course that it includes or shows, relative to the course."""
    references: Mapping[str, Any] = field(default_factory=dict)
    """Its definitions `[label]: target`, as markdown-it keeps them."""
    week: str = ""
    """The week of the course in which it is read, as its front matter says."""

    @property
    def interfaces(self) -> Iterator[ChapterCell]:
        """The cells that define messages, services and actions, in order."""
        return (cell for cell in self.cells if cell.kind is CellKind.INTERFACE)

    @property
    def files(self) -> Iterator[ChapterCell]:
        """The launch and parameter files of the package, in order."""
        return (cell for cell in self.cells if cell.kind is CellKind.FILE)

    @property
    def exercises(self) -> Iterator[ChapterCell]:
        """The cells that are exercises, in order."""
        return (cell for cell in self.cells if cell.kind is CellKind.EXERCISE)

    @property
    def nodes(self) -> Iterator[ChapterCell]:
        """The cells that are nodes, in order, without the programs of earlier chapters."""
        return (cell for cell in self.cells if cell.kind is CellKind.NODE and cell.shown_in is None)


#: nbformat allows 64 characters of [A-Za-z0-9_-].
_LONGEST_ID = 64


def make_cells(
    pieces: Iterable[Piece],
    classified: Mapping[int, ClassifiedFence],
    borrowed: Mapping[int, Sequence[ChapterCell]],
) -> tuple[ChapterCell, ...]:
    """Return the cells of a chapter. `classified` are its fences by their line, `borrowed` the programs of earlier
    chapters that the fence on a line runs."""
    ids = _Ids()
    cells: list[ChapterCell] = []
    lines: list[Piece] = []
    for piece in pieces:
        if piece.heading or piece.block is not None:
            cells.extend(_prose(lines, ids))
            lines = []
        if piece.block is None:
            lines.append(piece)
        elif piece.block.kind is BlockKind.EXERCISE:
            name = piece.block.title
            cells.append(ChapterCell(CellKind.EXERCISE, ids.named(f"exercise-{name}"), "", piece.block.line, name=name))
        elif piece.block.fence is not None:
            line = piece.block.fence.line
            cells.extend(_borrowed(cell, line, ids) for cell in borrowed.get(line, ()))
            cells.append(_runnable(classified[line], ids))
    cells.extend(_prose(lines, ids))
    return tuple(cells)


def _borrowed(cell: ChapterCell, line: int, ids: _Ids) -> ChapterCell:
    """Return a cell that saves an earlier chapter's whole program, for `ros2 run` to start."""
    name = ids.named(f"node-{cell.name}")
    whole = replace(cell, source=cell.whole, before="", after=(), replaces="", keeps=True)
    return replace(whole, id=name, line=line, tags=("hide-input",))


def _prose(pieces: list[Piece], ids: _Ids) -> Iterator[ChapterCell]:
    """Yield a piece of prose without the empty lines around it, which begins with the section's heading if it has
    one."""
    lines = [piece.line for piece in without_blanks_around(pieces) if piece.line is not None]
    if lines:
        heading = next((piece.line for piece in pieces if piece.heading), None)
        text = "\n".join(line.text for line in lines)
        yield ChapterCell(CellKind.PROSE, ids.prose(heading), text, lines[0].number)


def _runnable(item: ClassifiedFence, ids: _Ids) -> ChapterCell:
    fence = item.fence
    return ChapterCell(
        item.kind,
        _id(item, ids),
        fence.code,
        fence.first_code_line,
        name=item.name,
        seconds=float(fence.attributes["seconds"]) if "seconds" in fence.attributes else None,
        until=fence.attributes.get("until"),
        raises=fence.has("raises"),
        expects_error=fence.has("expect-error"),
        spin_classes=item.spin_classes,
        runs_main=item.runs_main,
        before=item.before,
        after=item.after,
        runs_in_kernel=item.runs_in_kernel,
        keeps=item.keeps,
        executables=item.executables,
        replaces=item.replaces,
        commands=item.commands,
        tags=fence.tags,
    )


def _id(item: ClassifiedFence, ids: _Ids) -> str:
    if item.kind in {CellKind.NODE, CellKind.PART, CellKind.INTERFACE, CellKind.FILE}:
        kind = item.kind.value.removeprefix("package_")
        return ids.named(f"{kind}-{(item.name or '').rpartition('/')[2]}")
    if item.kind is CellKind.SHELL:
        return ids.named(next(command for command in item.commands if command.kind is not CommandKind.NOTE).text)
    return ids.snippet()


class _Ids:
    """Names cells after their content, and adds a number if two would have the same name."""

    def __init__(self) -> None:
        self._section = "start"
        self._given: dict[str, int] = {}

    def prose(self, heading: SourceLine | None) -> str:
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
