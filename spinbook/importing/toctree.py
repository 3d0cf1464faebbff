"""Follows the toctrees of Sphinx, in reStructuredText and in MyST."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from spinbook.importing.pages import Pages


def pages_below(page: Path, root: Path, pages: Pages, seen: set[Path]) -> Iterator[str | Path]:
    """Yield a page, and those in its toctrees, each followed by its own; what is not found as it is written."""
    if page in seen:
        return
    seen.add(page)
    yield page
    text = page.read_text(encoding="utf-8", errors="replace") if page.suffix != ".ipynb" else ""
    for entry in _toctree(text.split("\n")):
        folder = root if entry.startswith("/") else page.parent
        children = pages.find_all(folder, entry.lstrip("/"))
        yield from () if children else (entry,)
        for child in children:
            yield from pages_below(child, root, pages, seen)


def _toctree(lines: list[str]) -> Iterator[str]:
    """Yield the entries of the toctrees in a page, of reStructuredText or MyST."""
    indent, is_myst = -1, False
    for line in lines:
        depth, text = len(line) - len(line.lstrip()), line.strip()
        if re.match(r"(?:\.\. toctree::|[`:]{3,}\s*\{toctree\})", text):
            indent, is_myst = depth, not text.startswith("..")
        elif indent >= 0 and text and ((depth <= indent and not is_myst) or set(text) <= {"`"} or set(text) == {":"}):
            indent = -1
        elif indent >= 0 and text and not text.startswith((":", "#", "---")) and "://" not in text:
            titled = re.search(r"<(.+)>$", text)
            yield titled[1] if titled else text
