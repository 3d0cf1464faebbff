"""Finds the fences and directives at the left margin of a chapter's Markdown, and what is wrong with its blocks."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

from spinbook.chapter.fence import Fence, make_fence
from spinbook.problem import Problem, Severity

#: `<!-- exercise: joint_velocity -->` on a line of its own: the exercise goes here.
_EXERCISE = re.compile(r"^<!--\s*exercise:\s*([\w-]+)\s*-->\s*$")


@dataclass(frozen=True)
class Span:
    """A block that stands at the left margin. Lines are 0-based, `end` is the first line behind it."""

    start: int
    end: int
    fence: Fence | None = None
    exercise: str | None = None


@dataclass(frozen=True)
class Outline:
    """What a chapter's Markdown holds besides prose. `heading` is the first one's text, if there is any."""

    spans: tuple[Span, ...]
    heading: str | None
    links: tuple[tuple[str, int], ...]
    """Targets of links and images that are neither anchors nor URLs -> line, counted from 1."""


def outline(text: str, file: Path) -> tuple[Outline, list[Problem]]:
    """Read the blocks of a chapter. `file` is what problems name."""
    tokens = MarkdownIt("commonmark").enable("table").parse(text)
    lines = text.split("\n")
    spans: list[Span] = []
    problems: list[Problem] = []
    links: list[tuple[str, int]] = []
    heading: str | None = None
    for index, token in enumerate(tokens):
        start, end = token.map or (0, 0)
        if token.type == "heading_open" and heading is None:
            heading = tokens[index + 1].content
        elif token.type == "fence":
            if problem := _unclosed(token, lines, file):
                problems.append(problem)
            elif token.level:
                problems.extend(_nested(token, file))
            else:
                spans.append(Span(start, end, fence=make_fence(token.info, token.content, start + 1)))
        elif token.type == "html_block" and not token.level:
            if directive := _EXERCISE.match(token.content.strip()):
                spans.append(Span(start, start + 1, exercise=directive.group(1)))
        elif token.type == "inline":
            links.extend(_links(token, start + 1))
    return Outline(tuple(spans), heading, tuple(links)), problems


def _unclosed(token: Token, lines: list[str], file: Path) -> Problem | None:
    start, end = token.map or (0, 0)
    last = lines[end - 1].lstrip(" >\t").rstrip() if end - 1 > start else ""
    if set(last) == {token.markup[0]} and len(last) >= len(token.markup):
        return None
    found = f"the code fence that opens here (`{lines[start].strip()[:60]}`) is never closed."
    return Problem(file, start + 1, found, f"Close it with a line of its own: {token.markup}")


def _nested(token: Token, file: Path) -> list[Problem]:
    fence = make_fence(token.info, token.content, (token.map or (0, 0))[0] + 1)
    if not (fence.is_python or fence.is_shell) or fence.has("static"):
        return []
    found = "a code fence inside a list or a quotation can't become a cell, so it is not run."
    mend = "Move it to the left margin, or write `static` behind its language to say that this is meant."
    return [Problem(file, fence.line, found, mend, Severity.WARNING)]


def _links(token: Token, line: int) -> list[tuple[str, int]]:
    found = []
    for child in token.children or []:
        if child.type in {"softbreak", "hardbreak"}:
            line += 1
        target = str(child.attrs.get("href") or child.attrs.get("src") or "")
        if target and not re.match(r"[a-z][a-z0-9+.-]*:|#|//", target, re.IGNORECASE):
            found.append((target, line))
    return found
