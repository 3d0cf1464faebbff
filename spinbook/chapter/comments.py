"""Removes HTML comments, in which authors write notes, from Markdown; text that markdown-it parses as code stays."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from itertools import accumulate

from markdown_it import MarkdownIt
from markdown_it.rules_inline import StateInline

from spinbook.chapter.flavours import parser
from spinbook.chapter.links import place_of, places_of, watch

_BEGIN, _END = "<!--", "-->"

#: A part of a text: where it begins, and where what follows it begins.
Span = tuple[int, int]


def without_comments(markdown: str, *, keep_lines: bool = False) -> str:
    """Return `markdown` without comments; a comment that never ends continues to the end of the text.

    A line with nothing else is removed or, with `keep_lines`, left empty, so that lines keep their numbers.
    """
    if _BEGIN not in markdown:
        return markdown
    cuts = list(_comments(markdown, list(_code(markdown))))
    kept = []
    for start, line in _numbered(markdown):
        shown, is_cut = _without(line, start, cuts)
        shown = shown.rstrip() if is_cut else shown
        if keep_lines or not is_cut or shown.strip():
            kept.append(shown)
    return "\n".join(kept)


def _comments(markdown: str, code: list[Span]) -> Iterator[Span]:
    at = 0
    while (at := markdown.find(_BEGIN, at)) >= 0:
        if inside := next((end for start, end in code if start <= at < end), 0):
            at = inside
            continue
        end = markdown.find(_END, at)
        yield at, (at := end + len(_END) if end >= 0 else len(markdown))


def _without(line: str, start: int, cuts: list[Span]) -> tuple[str, bool]:
    """Return what is left of a line, and whether a comment was in it."""
    end = start + len(line)
    here = [(max(a, start) - start, min(b, end) - start) for a, b in cuts if a <= end and b > start]
    left, at = "", 0
    for first, last in here:
        left += line[at:first]
        at = last
    return left + line[at:], bool(here)


def _numbered(markdown: str) -> Iterator[tuple[int, str]]:
    """Yield each line with its offset in the text."""
    lines = markdown.split("\n")
    starts = accumulate((len(line) + 1 for line in lines), initial=0)
    return zip(starts, lines, strict=False)


def _code(markdown: str) -> Iterator[Span]:
    lines = markdown.split("\n")
    starts = [start for start, _ in _numbered(markdown)]
    read_to = [0] * len(lines)
    for token in parser().parse(markdown):
        first, last = token.map or (0, 0)
        if token.type in {"fence", "code_block"}:
            yield starts[first], starts[last - 1] + len(lines[last - 1]) + 1
        elif token.type == "inline":
            places = list(places_of(lines, read_to, first, token.content))
            for start, end in _code_in_line(token.content):
                if place := place_of(places, token.content, start):
                    begin = starts[place[0]] + place[1]
                    yield begin, begin + end - start


def _code_in_line(content: str) -> list[Span]:
    spans: list[Span] = []
    md = _inline_parser()
    md.inline.parse(content, md, {"watched": content, "found": spans}, [])
    return spans


@functools.cache
def _inline_parser() -> MarkdownIt:
    md = MarkdownIt("commonmark", {"html": True})
    watch(md, "backticks", _code_span)
    return md


def _code_span(state: StateInline, start: int, before: int) -> list[Span]:
    return [(start, state.pos) for token in state.tokens[before:] if token.type == "code_inline"]
