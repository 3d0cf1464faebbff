"""Keeps together in one line: code and the punctuation that touches it, and the names of keys, such as Ctrl-C."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.transforms import SphinxTransform

_BEFORE, _AFTER = re.compile(r"[(\[“‘]+$"), re.compile(r"^[.,;:!?)\]”’]+")
_KEYS = re.compile(r"(Ctrl-[A-Z]\b)")


class KeepTogether(SphinxTransform):
    """Marks what no line may divide, although a browser would: next to code that a phone wraps, and at hyphens."""

    default_priority = 880

    def apply(self, **kwargs: Any) -> None:
        """Change the document's paragraphs and lists."""
        for literal in list(self.document.findall(nodes.literal)):
            _with_punctuation(literal)
        for text in list(self.document.findall(nodes.Text)):
            if _KEYS.search(text) and not isinstance(text.parent, nodes.literal | nodes.literal_block | nodes.raw):
                text.parent.replace(text, list(_pieces(text)))


def _with_punctuation(literal: nodes.literal) -> None:
    parent, at = literal.parent, literal.parent.index(literal)
    before, after = (parent[place] if 0 <= place < len(parent) else nodes.Text("") for place in (at - 1, at + 1))
    opening = _BEFORE.search(before) if isinstance(before, nodes.Text) else None
    closing = _AFTER.search(after) if isinstance(after, nodes.Text) else None
    if opening is None and closing is None:
        return
    together = _unbroken()
    parent.replace(literal, together)
    if opening:
        together.append(nodes.Text(opening[0]))
        parent.replace(before, nodes.Text(before[: opening.start()]))
    together.append(literal)
    if closing:
        together.append(nodes.Text(closing[0]))
        parent.replace(after, nodes.Text(after[closing.end() :]))


def _pieces(text: nodes.Text) -> Iterator[nodes.Node]:
    for piece in filter(None, _KEYS.split(text)):
        yield _unbroken(nodes.Text(piece)) if _KEYS.fullmatch(piece) else nodes.Text(piece)


def _unbroken(*children: nodes.Node) -> nodes.inline:
    return nodes.inline("", "", *children, classes=["unbroken"])
