"""The hints that belong to what a recording shows. Their texts are in hints.md."""

from __future__ import annotations

import pkgutil
import re
from functools import cache


def hints(name: str, **words: str) -> tuple[str, str]:
    """Return where to look and what to do, with `words` in place of those in braces.

    Raises KeyError if hints.md has no section of this name.
    """
    where, todo = texts()[name]
    for word, text in words.items():
        where, todo = where.replace(f"{{{word}}}", text), todo.replace(f"{{{word}}}", text)
    return where, todo


@cache
def texts() -> dict[str, tuple[str, str]]:
    """Return the two paragraphs of each section of hints.md, each on one line."""
    content = pkgutil.get_data(__package__, "hints.md")  # in a page, this package is in an archive
    assert content
    sections = re.split(r"^## (\w+)$", content.decode(), flags=re.MULTILINE)[1:]
    return dict(zip(sections[::2], map(_paragraphs, sections[1::2]), strict=True))


def _paragraphs(section: str) -> tuple[str, str]:
    where, todo = (" ".join(paragraph.split()) for paragraph in section.strip().split("\n\n"))
    return where, todo
