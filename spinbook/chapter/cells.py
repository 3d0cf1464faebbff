"""Puts a chapter's prose and fences in order, by jupytext, as cells with ids that stay and can be read.

jupytext knows how Markdown splits into cells. It would also run every ```` ```bash ```` and drop what it does not
know, so in place of each fence it is shown a placeholder of the same height, by which the fence is found again and
lines keep their numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import jupytext

from spinbook.chapter.chapter import Cell, CellKind
from spinbook.chapter.classify import Classified, FenceKind
from spinbook.chapter.markdown import Span
from spinbook.chapter.terminal import CommandKind

_FORMAT = {"extension": ".md", "format_name": "markdown", "split_at_heading": True}
#: Stands on every line of a fence that is shown and not run.
_SHOWN = "SPINBOOK-SHOWN-{}-FENCE"
_SHOWN_AGAIN = re.compile(r"(?:^SPINBOOK-SHOWN-(\d+)-FENCE$\n?)+", re.MULTILINE)
_EXERCISE = "SPINBOOK-EXERCISE-{}-HERE"
_EXERCISE_AGAIN = re.compile(r"^SPINBOOK-EXERCISE-(\d+)-HERE$", re.MULTILINE)
_HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*$", re.MULTILINE)
#: nbformat allows 64 characters of [A-Za-z0-9_-].
_LONGEST_ID = 64


def make_cells(text: str, spans: Sequence[Span], classified: Sequence[Classified]) -> tuple[Cell, ...]:
    """The cells of a chapter. `classified` goes with those `spans` that are fences, in order."""
    by_line = {item.fence.line: item for item in classified}
    masked, shown = _mask(text, spans, by_line)
    ids = _Ids()
    cells: list[Cell] = []
    position = 0
    for cell in jupytext.reads(masked, fmt=dict(_FORMAT)).cells:
        if cell.cell_type == "code":
            cells.append(_runnable(by_line[spans[int(cell.source)].start + 1], ids))
        elif cell.cell_type == "markdown" and cell.source.strip():
            position = max(position, masked.find(cell.source, position))
            cells.extend(_prose(cell.source, masked.count("\n", 0, position) + 1, shown, spans, ids))
    return tuple(cells)


def _mask(text: str, spans: Sequence[Span], by_line: dict[int, Classified]) -> tuple[str, dict[int, str]]:
    """The text with a placeholder for each span, and the text of those fences that stay in the prose."""
    lines = text.split("\n")
    shown: dict[int, str] = {}
    for index, span in enumerate(spans):
        height = span.end - span.start
        if span.exercise:
            lines[span.start : span.end] = [_EXERCISE.format(index)]
        elif by_line[span.start + 1].kind is FenceKind.STATIC:
            shown[index] = "\n".join(lines[span.start : span.end])
            lines[span.start : span.end] = [_SHOWN.format(index)] * height
        else:
            lines[span.start : span.end] = ["```python", str(index), *[""] * (height - 3), "```"]
    return "\n".join(lines), shown


def _prose(source: str, line: int, shown: dict[int, str], spans: Sequence[Span], ids: _Ids) -> Iterator[Cell]:
    """A piece of prose, cut where an exercise goes, with the fences that it shows put back."""
    for index, piece in enumerate(_EXERCISE_AGAIN.split(source)):
        if index % 2:
            name = spans[int(piece)].exercise or ""
            yield Cell(CellKind.EXERCISE, ids.named(f"exercise-{name}"), "", line, name=name)
        elif piece.strip():
            # The id is made before fences are put back: a comment in a fence looks like a heading.
            cell_id = ids.prose(piece)
            blank = len(piece) - len(piece.lstrip("\n"))
            text = _SHOWN_AGAIN.sub(lambda match: shown[int(match.group(1))] + "\n", piece)
            yield Cell(CellKind.PROSE, cell_id, text.strip("\n"), line + blank)
        line += piece.count("\n") if not index % 2 else 0


def _runnable(item: Classified, ids: _Ids) -> Cell:
    fence = item.fence
    seconds = float(fence.attributes["seconds"]) if "seconds" in fence.attributes else None
    kind = {
        FenceKind.NODE: CellKind.NODE,
        FenceKind.SNIPPET: CellKind.SNIPPET,
        FenceKind.SHELL: CellKind.SHELL,
        FenceKind.INTERFACE: CellKind.INTERFACE,
    }[item.kind]
    if item.kind is FenceKind.NODE:
        cell_id = ids.named(f"node-{item.name}")
    elif item.kind is FenceKind.INTERFACE:
        cell_id = ids.named(f"interface-{(item.name or '').rpartition('/')[2]}")
    elif item.kind is FenceKind.SHELL:
        first = next(command for command in item.commands if command.kind is not CommandKind.NOTE)
        cell_id = ids.named(first.text)
    else:
        cell_id = ids.snippet()
    return Cell(
        kind,
        cell_id,
        fence.code,
        fence.first_code_line,
        name=item.name,
        seconds=seconds,
        until=fence.attributes.get("until"),
        raises=fence.has("raises"),
        spin_class=item.spin_class,
        commands=item.commands,
    )


class _Ids:
    """Names cells for what they hold, and counts where two would have one name."""

    def __init__(self) -> None:
        self._section = "start"
        self._given: dict[str, int] = {}

    def prose(self, source: str) -> str:
        if heading := _HEADING.search(source):
            self._section = _slug(heading.group(1)) or "section"
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
