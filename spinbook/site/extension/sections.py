"""What the search looks through: every section of the site, its heading, its words, its address.

Sphinx's own index knows pages, and needs a server to show what it found in them. Chapters are long, and a reader who
looks for "publisher" wants the section; a page opened from a folder has no server.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx

from spinbook.site.names import HOME
from spinbook.written import write_if_changed

FILE = "_static/search-data.js"


def no_index_of_sphinx(app: Sphinx) -> None:
    """Keep Sphinx from writing an index that nobody reads."""
    app.builder.search = False  # type: ignore[attr-defined]


def write(app: Sphinx, error: Exception | None) -> None:
    """Write the sections of every page."""
    if error is None:
        rows = [row for page in sorted(app.env.found_docs) if page != HOME for row in _sections(app, page)]
        text = ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows)
        write_if_changed(Path(app.outdir, FILE), f"const courseSections = [\n{text}\n];\n")


def _sections(app: Sphinx, page: str) -> Iterator[tuple[str, str, str, str]]:
    """Address, page's title, section's title, and the section's words without those of its subsections."""
    title = app.env.titles[page].astext()
    for section in app.env.get_doctree(page).findall(nodes.section):
        heading = next((child.astext() for child in section.children if isinstance(child, nodes.title)), "")
        words = " ".join(_words(section))
        yield f"{page}.html#{section['ids'][0]}", title, heading, re.sub(r"\s+", " ", words).strip()


def _words(node: nodes.Element) -> Iterator[str]:
    for child in node.children:
        if isinstance(child, (nodes.section, nodes.title, nodes.raw, nodes.comment)):
            continue
        if isinstance(child, nodes.container) and child.get("nb_element") == "cell_code_output":
            continue
        if isinstance(child, (nodes.TextElement, nodes.math_block)):
            yield child.astext()
        elif isinstance(child, nodes.Element):
            yield from _words(child)
