"""Adapts the Markdown of chapters and tasks to Sphinx's MyST parser, and reads the glossary."""

from __future__ import annotations

import hashlib
import posixpath
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any
from urllib.parse import quote, unquote

from docutils.nodes import make_id
from markdown_it.token import Token

from spinbook.chapter.comments import without_comments
from spinbook.chapter.fence import directive, parse_info
from spinbook.chapter.files import is_elsewhere, locate, split
from spinbook.chapter.flavours import parser
from spinbook.chapter.links import linked
from spinbook.site.page import Repository

# MyST renders alerts, admonitions, tables and maths. This module makes links lead to pages of the site or into the
# repository, copies pictures next to the pages, and turns mermaid fences into pictures. It adds and removes no lines,
# so that line numbers in messages are right.


#: A mermaid drawing's code -> the HTML that shows it, in one line.
Draw = Callable[[str], str]
#: The folder of the chapters' pictures and linked files, in the staged folder and in the site.
PICTURES = "pictures"
_SHOWN = frozenset({".png", ".jpg", ".jpeg", ".gif", ".svg", ".webp", ".avif", ".mp4", ".webm"})


@dataclass(frozen=True)
class Links:
    """Resolves the links of the text. `pages` maps files of the course to pages; all paths are relative to the course.

    `pictures` collects the files that the pages show or lead to: path in the site -> content. `anchors` are the
    headings' ids on the site, by file and the id that JupyterLab gives them.
    """

    pages: Mapping[str, str]
    repository: Repository
    pictures: dict[str, bytes] = field(default_factory=dict)
    anchors: Mapping[tuple[str, str], str] = field(default_factory=dict)

    def target(self, target: str, is_image: bool, folder: str, page_folder: str) -> str | None:
        """Return the target of a link in a file of `folder`, for a page in `page_folder`; None if it is unchanged."""
        if is_elsewhere(target):
            return None
        path, anchor = split(target)
        file = locate(self.repository.root, folder, target)
        full = file.as_posix() if file else posixpath.normpath(posixpath.join(folder, path))
        if full in self.pages:
            slug = self.anchors.get((full, unquote(anchor[1:])))
            return posixpath.relpath(self.pages[full], page_folder or ".") + (f"#{slug}" if slug else anchor)
        if file is not None and (file.suffix.lower() in _SHOWN if is_image else self._has_no_other_place(file)):
            return posixpath.relpath(self._copied(file, is_image), page_folder or ".")
        link = self.repository.link(Path(full))
        return quote(link, safe=":/?#=&%") + anchor if link else None

    def _has_no_other_place(self, file: Path) -> bool:
        """Return whether readers get a linked file only if it is on the site: the course has no repository."""
        is_file = (self.repository.root / file).is_file()
        return is_file and not self.repository.url and file.parts[0] != "solutions"

    def _copied(self, file: Path, is_image: bool) -> str:
        data = (self.repository.root / file).read_bytes()
        # Readers save a linked file under its own name.
        ending = file.suffix.lower() if is_image else "/" + re.sub(r"[^\w.-]+", "-", file.name)
        name = f"{PICTURES}/{hashlib.sha256(data).hexdigest()[:16]}{ending}"
        self.pictures[name] = data
        return name


def rich(
    text: str,
    links: Links,
    folder: str,
    page_folder: str,
    draw: Draw,
    references: Mapping[str, Any] = MappingProxyType({}),
) -> str:
    """Return `text`, from a file in `folder`, for a page in `page_folder`; without the authors' comments.

    `references` are the definitions `[label]: target` in the rest of the file.
    """
    plain = without_comments(text, keep_lines=True)

    def target(target: str, is_image: bool) -> str | None:
        return links.target(target, is_image, folder, page_folder)

    lines = linked(plain, target, references).split("\n")
    # This comes after the links, because a drawing's address leads to the site, not to a file of the course.
    for token in parser().parse("\n".join(lines)):
        if token.type == "fence" and token.map:
            _fence(token, lines, draw)
    return "\n".join(lines)


def _fence(token: Token, lines: list[str], draw: Draw) -> None:
    """Replace mermaid's code with a drawing; remove Spinbook's attributes from any other fence."""
    start, end = token.map or (0, 0)
    if directive(token.info)[0] or not token.info.strip():
        return
    language, _ = parse_info(token.info)
    written = token.info.strip().split(" ")[0].split("{")[0] or language
    if language == "mermaid" and lines[end - 1].strip().startswith(token.markup):
        lines[start:end] = [draw(token.content.rstrip("\n")), *[""] * (end - start - 1)]
    else:
        lines[start] = lines[start][: len(lines[start]) - len(token.info)] + (
            "text" if language == "mermaid" else written
        )


_SHORT = re.compile(r"^(.*?)\s*\(([^)]+)\)$")


@dataclass(frozen=True)
class Term:
    """A term, its spellings, and its anchor on the glossary's page, as Sphinx makes it."""

    title: str
    forms: tuple[str, ...]
    anchor: str


def terms_of(text: str) -> tuple[Term, ...]:
    """Return the terms of a glossary. `## Quality of service (QoS)` has both names as spellings, and their plurals."""
    tokens = pairwise(parser().parse(text))
    return tuple(_term(words.content) for token, words in tokens if (token.type, token.tag) == ("heading_open", "h2"))


def _term(heading: str) -> Term:
    title = heading.replace("`", "")
    short = _SHORT.match(title)
    names = [short.group(1), short.group(2)] if short else [title]
    forms = [form for name in names for form in (name, f"{name[:-1]}ies" if name.endswith("y") else f"{name}s")]
    return Term(title, tuple(dict.fromkeys(forms)), str(make_id(title)))
