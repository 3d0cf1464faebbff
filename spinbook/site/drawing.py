"""A mermaid fence as a page shows it: a picture with its meaning in words, or only the words."""

from __future__ import annotations

import html
import re
from collections.abc import Iterator

from spinbook.build.digest import digest
from spinbook.site.mermaid import Picture

FOLDER = "_drawings"
#: A drawing wider than this (px) could not be read if it were made as narrow as a phone: it scrolls there.
_WIDE = 640
#: A node of a flowchart: A(["left toe"]), A["/topic"], A{{…}} or a bare A.
_NODE = r"""(?P<{0}>\w+)(?:[(\[{{<>]+\s*"?(?P<{0}_label>[^"\])}}]*)"?\s*[)\]}}]+)?"""
_LINK = r"""\s*(?:<?[-=.]+(?:\s*"?(?P<on>[^"|>-]+)"?\s*[-=.]+)?>?(?:\|(?P<label>[^|]*)\|)?)\s*"""
_EDGE = re.compile(_NODE.format("start") + _LINK + _NODE.format("end"))
_SAYS = re.compile(r"^\s*acc(?:Title|Descr)\s*:\s*(.+)$", re.MULTILINE)


def in_words(code: str) -> str:
    """What a drawing says, for those who don't see it: its own accDescr, else which node leads to which.

    "" where it is no flowchart, or one whose edges can't be read.
    """
    if said := _SAYS.findall(code):
        return ". ".join(line.strip().rstrip(".") for line in said) + "."
    steps = [f"{start} to {end}" for start, end in _edges(code)]
    return f"Drawing: {'; '.join(steps)}." if steps else ""


def _edges(code: str) -> Iterator[tuple[str, str]]:
    labels: dict[str, str] = {}
    found: list[tuple[str, str]] = []
    for line in code.splitlines():
        match = _EDGE.search(line)
        if not match:
            continue
        for end in ("start", "end"):
            if match.group(f"{end}_label"):
                labels[match.group(end)] = match.group(f"{end}_label").strip()
        found.append((match.group("start"), match.group("end")))
    for start, end in found:
        yield labels.get(start, start), labels.get(end, end)


def drawing_files(code: str, picture: Picture) -> dict[str, str]:
    """The files of a drawing: path in the site -> SVG."""
    return {_path(code, "light"): picture.light, _path(code, "dark"): picture.dark}


def drawing_html(code: str, picture: Picture | None, root: str) -> str:
    """A drawing in one line of HTML, for a page from which `root` leads to the site's own folder."""
    words = html.escape(in_words(code))
    if picture is None:
        return _without_picture(code)
    wide = " drawing-wide" if picture.width > _WIDE else ""
    size = f'width="{picture.width}" height="{picture.height}" loading="lazy"'
    images = "".join(
        f'<img class="only-{theme}" src="{root}{_path(code, theme)}" alt="{words or "Drawing"}" {size}>'
        for theme in ("light", "dark")
    )
    return f'<figure class="drawing{wide}">{images}</figure>'


def _without_picture(code: str) -> str:
    edges = list(_edges(code))
    if not edges:
        lines = "&#10;".join(html.escape(line) for line in code.splitlines() if line.strip())
        return f'<pre class="drawing-code" tabindex="0">{lines}</pre>'
    items = "".join(f"<li>{html.escape(start)} → {html.escape(end)}</li>" for start, end in edges)
    return f'<ul class="drawing-words">{items}</ul>'


def _path(code: str, theme: str) -> str:
    return f"{FOLDER}/{digest(code)[:16]}-{theme}.svg"
