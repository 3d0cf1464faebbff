"""Links the first use of each of the glossary's terms on a page to its entry."""

from __future__ import annotations

import posixpath
import re
from typing import Any

from docutils import nodes
from sphinx.transforms import SphinxTransform

from spinbook.site.names import GLOSSARY

_NOT_IN = (nodes.title, nodes.reference, nodes.literal, nodes.raw, nodes.math, nodes.caption, nodes.literal_block)


class LinkTerms(SphinxTransform):
    """Works on chapters and exercises; code, headings, links and tables stay as they are."""

    default_priority = 850

    def apply(self, **kwargs: Any) -> None:
        """Change the document."""
        page = self.env.docname
        terms: dict[str, str] = dict(self.config.spinbook_terms)
        if "/" not in page or not terms:
            return
        glossary = posixpath.relpath(f"{GLOSSARY}.html", posixpath.dirname(page))
        longest = sorted(terms, key=len, reverse=True)
        pattern = re.compile(rf"\b(?:{'|'.join(map(re.escape, longest))})\b", re.IGNORECASE)
        by_lower = {form.lower(): anchor for form, anchor in terms.items()}
        seen: set[str] = set()
        for text in list(self.document.findall(nodes.Text)):
            if _is_prose(text):
                _link(text, pattern, by_lower, seen, glossary)


def _is_prose(text: nodes.Text) -> bool:
    parent = text.parent
    in_paragraph = False
    while parent is not None and not isinstance(parent, nodes.document):
        if isinstance(parent, (*_NOT_IN, nodes.table)):
            return False
        in_paragraph = in_paragraph or isinstance(parent, nodes.paragraph)
        parent = parent.parent
    return in_paragraph


def _link(text: nodes.Text, pattern: re.Pattern[str], anchors: dict[str, str], seen: set[str], glossary: str) -> None:
    whole = text.astext()
    pieces: list[nodes.Node] = []
    position = 0
    for match in pattern.finditer(whole):
        anchor = anchors[match.group().lower()]
        if anchor in seen:
            continue
        seen.add(anchor)
        pieces.append(nodes.Text(whole[position : match.start()]))
        target = f"{glossary}#{anchor}"
        pieces.append(nodes.reference("", match.group(), refuri=target, internal=True, classes=["term"]))
        position = match.end()
    if pieces:
        text.parent.replace(text, [*pieces, nodes.Text(whole[position:])])
