"""Moves what is indented inside MDX components and `:::` containers to the left, as MDX reads it.

MDX has no indented code, so authors indent what a component holds, also fences. In Markdown, four spaces make code.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

_TAG = re.compile(r"^\s*<(?P<close>/?)(?P<name>[A-Z][\w.]*)(?P<rest>[^<]*)$")
_CONTAINER = re.compile(r"^\s*(?P<colons>:{3,})\s*(?P<name>.*)$")
_FENCE = re.compile(r"^\s*(`{3,}|~{3,})")


def unindented(text: str) -> str:
    """Return a chapter's text with the content of each component in its tag's column. No line is added or lost."""
    if not re.search(r"^[ \t]*(?:<[A-Z]|:::)", text, re.MULTILINE):
        return text
    lines = text.split("\n")
    for first, last, indent in sorted(_pairs(lines)):
        inside = range(first + 1, last)
        content = next((lines[i] for i in inside if lines[i].strip()), "")
        indent = min(indent, _indent(lines[first]))
        shift = _indent(content) - indent
        if shift <= 0 or (shift < 4 and lines[first].lstrip().startswith(":")):
            continue
        for i in inside:
            lines[i] = lines[i][min(shift, _indent(lines[i])) :]
        lines[last] = " " * indent + lines[last].lstrip()
    return "\n".join(lines)


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


def _pairs(lines: list[str]) -> Iterator[tuple[int, int, int]]:
    """Yield the lines that open and close a component or a container outside fences, and the first one's indentation.

    An opening tag may take several lines: the last of them counts, and the indentation of the first.
    """
    fence = ""
    opened: list[tuple[str, int, int]] = []
    unfinished, indent = "", 0
    for number, line in enumerate(lines):
        if mark := _FENCE.match(line):
            if not fence:
                fence = mark[1]
            elif mark[1].startswith(fence) and set(line.strip()) == {fence[0]}:
                fence = ""
            continue
        if fence:
            continue
        if unfinished and line.rstrip().endswith(">"):
            if not line.rstrip().endswith("/>"):
                opened.append((unfinished, number, indent))
            unfinished = ""
        elif tag := _TAG.match(line):
            name, rest = tag["name"], tag["rest"].rstrip()
            if tag["close"]:
                yield from _closed(opened, name, number)
            elif not rest.endswith(">"):
                unfinished, indent = name if ">" not in rest else "", _indent(line)
            elif not rest.endswith("/>"):
                opened.append((name, number, _indent(line)))
        elif container := _CONTAINER.match(line):
            if container["name"]:
                opened.append((container["colons"], number, _indent(line)))
            else:
                yield from _closed(opened, container["colons"], number)


def _closed(opened: list[tuple[str, int, int]], name: str, number: int) -> Iterator[tuple[int, int, int]]:
    """Yield the pair that a closing line ends, and forget what was never closed inside it."""
    at = next((i for i in range(len(opened) - 1, -1, -1) if opened[i][0] == name), None)
    if at is not None:
        yield opened[at][1], number, opened[at][2]
        del opened[at:]
