"""Blocks that belong together: what is between two tags, and what Kramdown's `{: .note }` is about."""

from __future__ import annotations

from dataclasses import replace

from spinbook.chapter.fence import make_fence
from spinbook.course import attributes
from spinbook.course.block import Block, Kind, as_fence, unquoted


def merged_callouts(found: list[Block]) -> list[Block]:
    """Kramdown's `{: .note }` before or behind a paragraph or quotation makes it an admonition."""
    out: list[Block] = []
    style = ""
    for block in found:
        if block.kind is Kind.DROPPED and block.style in attributes.STYLES:
            if out and out[-1].kind in {Kind.TEXT, Kind.QUOTE} and out[-1].lines[-1].text.strip():
                out[-1] = _called_out(out[-1], block.style)
            else:
                style = block.style
            continue
        if style and block.kind in {Kind.TEXT, Kind.QUOTE} and any(line.text.strip() for line in block.lines):
            block, style = _called_out(block, style), ""
        out.append(block)
    return out


def _called_out(block: Block, style: str) -> Block:
    quoted = block.lines[0].text.lstrip().startswith(">")
    lines = tuple(unquoted(line) for line in block.lines) if quoted else block.lines
    return Block(Kind.ADMONITION, block.lines, (Block(Kind.TEXT, lines),), style=style)


def paired(found: list[Block]) -> tuple[Block, ...]:
    """Opening and closing tags become one block that holds what is between them."""
    stack: list[tuple[Block | None, list[Block]]] = [(None, [])]
    for block in found:
        if block.kind is Kind.DROPPED and block.style == "open" and block.title in attributes.PAIRED:
            stack.append((block, []))
        elif block.kind is Kind.DROPPED and block.style == "close" and block.title in attributes.PAIRED:
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
    given = attributes.pairs(opened.new[0].text if opened.new else "")
    words = opened.new[0].text if opened.new else ""
    kind, style, title = attributes.paired(opened.title, given, words)
    summary = next((block for block in inner if block.style == "summary"), None)
    if summary and summary.new:
        title = summary.new[0].text
    lines = (*opened.lines, *(line for block in inner for line in block.lines), *(closing.lines if closing else ()))
    inner = [block for block in inner if block is not summary]
    if opened.title == "highlight":
        code = "".join(f"{line.text}\n" for block in inner for line in block.lines)
        fence = make_fence(words.split(" ")[0] or "text", code, opened.line)
        return Block(Kind.FENCE, lines, fence=fence, new=as_fence(fence, lines))
    if opened.title == "details" and summary is None and "title" not in given:
        title = "Details"
    return Block(Kind(kind), lines, tuple(inner), title, style)
