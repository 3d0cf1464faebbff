"""A block of a chapter: text, a fence, or a container of other blocks, and which blocks belong together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum

from spinbook.chapter import attributes
from spinbook.chapter.fence import Fence, make_fence


class BlockKind(Enum):
    """The kind of a block. The kinds from ADMONITION on hold other blocks."""

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


#: What may have the name of the file that it holds as its title.
HOLDS_FILE = frozenset({BlockKind.TAB, BlockKind.DETAILS, BlockKind.GROUP})


@dataclass(frozen=True)
class SourceLine:
    """A line of the chapter, without the indentation of its container. `number` counts from 1 in the chapter."""

    text: str
    number: int


@dataclass(frozen=True)
class Block:
    """One block. `lines` are as the author wrote them; `title` and `style` say what an admonition or a tab is called.

    `new` are the lines that replace the author's if Markdown tools would not understand those; None keeps the author's.
    """

    kind: BlockKind
    lines: tuple[SourceLine, ...]
    children: tuple[Block, ...] = ()
    title: str = ""
    style: str = ""
    fence: Fence | None = None
    closed: bool = True
    new: tuple[SourceLine, ...] | None = None
    offset: int = 0
    """How far the text of a list's item is indented."""
    label: str = ""
    """The name that MyST's references use for it or, if it is dropped, for what follows."""

    @property
    def line(self) -> int:
        """The chapter's line on which it begins."""
        return self.lines[0].number if self.lines else 1

    def walk(self) -> Iterator[Block]:
        """Yield this block and all blocks in it, in order."""
        yield self
        for child in self.children:
            yield from child.walk()


def unquoted(line: SourceLine) -> SourceLine:
    """Return a line of a quotation without its `>`."""
    text = line.text.lstrip()
    if not text.startswith(">"):
        return SourceLine(text, line.number)
    return SourceLine(text[1:].removeprefix(" "), line.number)


def as_fence(fence: Fence, lines: tuple[SourceLine, ...]) -> tuple[SourceLine, ...]:
    """Return the lines of a plain fence that replace these."""
    number = lines[0].number
    title = f' title="{fence.title}"' if fence.title else ""
    code = [SourceLine(text, number) for text in fence.code.rstrip("\n").split("\n")]
    mark = "````" if "```" in fence.code else "```"
    return (SourceLine(f"{mark}{fence.language}{title}", number), *code, SourceLine(mark, lines[-1].number))


def fence_block(fence: Fence, lines: tuple[SourceLine, ...], *, closed: bool = True) -> Block:
    """Return the block of a fence that is written anew in place of these lines."""
    return Block(BlockKind.FENCE, lines, fence=fence, closed=closed, new=as_fence(fence, lines))


def merged_callouts(blocks: list[Block]) -> list[Block]:
    """Make an admonition of each paragraph or quotation with kramdown's `{: .note }` before or after it."""
    out: list[Block] = []
    mark: Block | None = None
    for block in blocks:
        if block.kind is BlockKind.DROPPED and block.style in attributes.STYLES:
            if out and out[-1].kind in {BlockKind.TEXT, BlockKind.QUOTE} and out[-1].lines[-1].text.strip():
                out[-1] = _called_out(out[-1], block)
            else:
                mark = block
            continue
        if mark and block.kind in {BlockKind.TEXT, BlockKind.QUOTE} and any(line.text.strip() for line in block.lines):
            block, mark = _called_out(block, mark), None
        out.append(block)
    return out


def _called_out(block: Block, mark: Block) -> Block:
    """Return the block in a box; after `{: .note-title }`, its first line is the title."""
    quoted = block.lines[0].text.lstrip().startswith(">")
    lines = tuple(unquoted(line) for line in block.lines) if quoted else block.lines
    title = lines[0].text.strip() if mark.title else ""
    inner = (Block(BlockKind.TEXT, lines[1:] if title else lines),)
    return Block(BlockKind.ADMONITION, block.lines, inner, title, mark.style)


def quarto_title(name: str, inner: list[SourceLine]) -> str:
    """Take the title out of Quarto's `::: {.callout-tip}`: a heading that is its first line; "" if there is none."""
    at = next((at for at, line in enumerate(inner) if line.text.strip()), -1)
    if at < 0 or not name.startswith("callout-") or not inner[at].text.startswith("#"):
        return ""
    return inner.pop(at).text.lstrip("#").strip()


def closes(markup: str, lines: tuple[SourceLine, ...]) -> bool:
    """Return whether the last line of a fence closes it."""
    last = lines[-1].text.strip() if len(lines) > 1 else ""
    return set(last) == {markup[0]} and len(last) >= len(markup)


def paired(blocks: list[Block]) -> tuple[Block, ...]:
    """Join an opening tag and its closing tag to one block that holds what is between them."""
    stack: list[tuple[Block | None, list[Block]]] = [(None, [])]
    for block in blocks:
        role = block.style if block.kind is BlockKind.DROPPED and attributes.is_paired(block.title) else ""
        if role == "open":
            stack.append((block, []))
        elif role == "close":
            if any(opened and opened.title == block.title for opened, _ in stack):
                while True:
                    opened, inner = stack.pop()
                    assert opened is not None
                    closing = block if opened.title == block.title else None
                    stack[-1][1].append(_pair(opened, inner, closing))
                    if closing:
                        break
        else:
            stack[-1][1].append(block)
    while len(stack) > 1:
        # A tag that is never closed: what follows stays.
        opened, inner = stack.pop()
        assert opened is not None
        stack[-1][1].extend([replace(opened, style="", title="", new=None), *inner])
    return tuple(stack[0][1])


def _pair(opened: Block, inner: list[Block], closing: Block | None) -> Block:
    words = opened.new[0].text if opened.new else ""
    properties = attributes.pairs(words)
    kind, style, title = attributes.paired(opened.title, properties, words)
    summary = next((block for block in inner if block.style == "summary"), None)
    if summary and summary.new:
        title = summary.new[0].text
    lines = (*opened.lines, *(line for block in inner for line in block.lines), *(closing.lines if closing else ()))
    inner = [block for block in inner if block is not summary]
    if opened.title == "highlight":
        code = "".join(f"{line.text}\n" for block in inner for line in block.lines)
        return fence_block(make_fence(words.split(" ")[0] or "text", code, opened.line), lines)
    if opened.title == "details" and summary is None and "title" not in properties:
        title = "Details"
    return Block(BlockKind(kind), lines, tuple(inner), title, style)


def offset_of(text: str, marker: int) -> int:
    """Return how far an item's text is indented, by CommonMark's rule: up to four spaces may follow the marker."""
    start = len(text) - len(text.lstrip()) + marker
    spaces = len(text[start:]) - len(text[start:].lstrip(" "))
    return start + (spaces if 1 <= spaces <= 4 else 1)


def dedented(lines: Sequence[SourceLine], indent: int) -> list[SourceLine]:
    """Return lines without their first columns of indentation."""
    out = []
    for line in lines:
        text = line.text.expandtabs(4) if line.text[:indent].count("\t") else line.text
        strip = min(indent, len(text) - len(text.lstrip(" ")))
        out.append(SourceLine(text[strip:], line.number))
    return out


@dataclass(frozen=True)
class Directive:
    """A directive of MyST: all its `lines`, and its `body` after the options, which take `skipped` lines."""

    name: str
    argument: str
    options: dict[str, str]
    lines: tuple[SourceLine, ...]
    body: list[SourceLine]
    skipped: int
    closed: bool

    @property
    def code(self) -> str:
        """The body as a fence's code."""
        return "".join(f"{line.text}\n" for line in self.body)

    def between(self, opening: str, closing: str) -> tuple[SourceLine, ...]:
        """Return the body between two other lines."""
        return (SourceLine(opening, self.lines[0].number), *self.body, SourceLine(closing, self.lines[-1].number))
