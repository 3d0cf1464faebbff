"""A block of a chapter: text, a fence, or what holds other blocks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from spinbook.chapter.fence import Fence


class Kind(Enum):
    """What a block is. Those from ADMONITION on hold blocks."""

    TEXT = "text"
    HEADING = "heading"
    FENCE = "fence"
    EXERCISE = "exercise"
    DROPPED = "dropped"
    ADMONITION = "admonition"
    TAB = "tab"
    DETAILS = "details"
    LIST = "list"
    ITEM = "item"
    QUOTE = "quote"
    GROUP = "group"


@dataclass(frozen=True)
class Line:
    """A line of the chapter, without the indentation of what holds it. `number` counts from 1 in the chapter."""

    text: str
    number: int


@dataclass(frozen=True)
class Block:
    """One block. `lines` are as the author wrote them; `title` and `style` say what an admonition or a tab is called.

    `new` are the lines that stand for it where the author's would not be understood; None: the author's will do.
    """

    kind: Kind
    lines: tuple[Line, ...]
    children: tuple[Block, ...] = ()
    title: str = ""
    style: str = ""
    fence: Fence | None = None
    closed: bool = True
    new: tuple[Line, ...] | None = None
    offset: int = 0
    """How far the text of a list's item is indented."""

    @property
    def line(self) -> int:
        """The chapter's line on which it begins."""
        return self.lines[0].number if self.lines else 1

    def walk(self) -> Iterator[Block]:
        """This block and all that it holds, in order."""
        yield self
        for child in self.children:
            yield from child.walk()


def unquoted(line: Line) -> Line:
    """A line of a quotation without its mark."""
    text = line.text.lstrip()
    if not text.startswith(">"):
        return Line(text, line.number)
    return Line(text[1:].removeprefix(" "), line.number)


def as_fence(fence: Fence, lines: tuple[Line, ...]) -> tuple[Line, ...]:
    """The lines of a plain fence in place of these."""
    number = lines[0].number
    title = f' title="{fence.title}"' if fence.title else ""
    code = [Line(text, number) for text in fence.code.rstrip("\n").split("\n")]
    mark = "````" if "```" in fence.code else "```"
    return (Line(f"{mark}{fence.language}{title}", number), *code, Line(mark, lines[-1].number))
