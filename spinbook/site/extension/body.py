"""The last touches to a page's HTML, before the theme puts its frame around it."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from docutils import nodes
from PIL import Image
from sphinx.application import Sphinx

from spinbook.site.names import FRAME_SUFFIX

_IMAGE = re.compile(r"<img\b[^>]*>")
_SOURCE = re.compile(r'\bsrc="([^"]+)"')
_HEADING_LINK = re.compile(r'<a class="headerlink" href="(#[^"]*)" title="[^"]*">[^<]*</a>')
_EMPTY_HEAD = re.compile(r'<th class="head[^"]*">\s*(?:<p></p>)?\s*</th>')
_STYLE = re.compile(r'\sstyle="[^"]*"')


def finish(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: nodes.document | None) -> None:
    """Give pictures their size, headings' links a name, and tables a frame that scrolls."""
    context["frame"] = _frame(app, page)
    if "body" not in context:
        return
    body = context["body"]
    # A strict content security policy allows no styles in the page itself.
    body = _STYLE.sub("", body)
    folder = Path(app.outdir, page).parent
    body = _IMAGE.sub(lambda match: _sized(match.group(), folder, app), body)
    body = _HEADING_LINK.sub(r'<a class="headerlink" href="\1" aria-label="Link to this section">#</a>', body)
    body = _EMPTY_HEAD.sub("<td></td>", body)
    if context.get("display_toc"):
        contents = f'<details class="page-toc-small"><summary>On this page</summary>{context["toc"]}</details>'
        body = body.replace("</h1>", f"</h1>\n{contents}", 1)
    body = body.replace("<table", '<div class="table"><table').replace("</table>", "</table></div>")
    context["body"] = body


def _frame(app: Sphinx, page: str) -> dict[str, Any]:
    """What was staged beside the page for the theme."""
    try:
        frame = json.loads(Path(app.srcdir, f"{page}{FRAME_SUFFIX}").read_text(encoding="utf-8"))
    except OSError:
        return {"kind": "search"}
    return dict(frame)


def depend(app: Sphinx, page: str, source: list[str]) -> None:
    """A page is made again when what stands beside it changes."""
    app.env.note_dependency(f"{page}{FRAME_SUFFIX}")


def _size(file: Path) -> tuple[int, int]:
    """Width and height of a picture in CSS pixels. Raises OSError or ValueError where it does not say."""
    if file.suffix != ".svg":
        with Image.open(file) as image:
            return int(image.width), int(image.height)
    opening = file.read_text(encoding="utf-8").partition(">")[0]
    sizes = dict(re.findall(r'\b(width|height)="([\d.]+)(?:px)?"', opening))
    if len(sizes) < 2:
        raise ValueError(file)
    return round(float(sizes["width"])), round(float(sizes["height"]))


def _sized(tag: str, folder: Path, app: Sphinx) -> str:
    source = _SOURCE.search(tag)
    if source is None or " width=" in tag or 'class="still"' in tag:
        # What is shown on paper only must be there when somebody prints, and so is not left for later.
        return tag
    # Sphinx copies pictures after the pages are written; it knows already what they will be called.
    name = Path(source.group(1)).name
    original = next((Path(app.srcdir, at) for at, (_, to) in app.env.images.items() if to == name), folder / name)
    try:
        width, height = _size(original)
    except (OSError, ValueError):
        return f'{tag.rstrip("/> ")} loading="lazy">'
    return f'{tag.rstrip("/> ")} width="{width}" height="{height}" loading="lazy">'
