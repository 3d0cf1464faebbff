"""Makes a chapter's or a task's Markdown into what Sphinx's MyST parser shows at its best.

Alerts, admonitions, tables and maths are MyST's own matter. What is done here: links lead to pages of the site or into
the repository, and mermaid fences become pictures. No line is added or lost, so that a line of the text is known by
its number still.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from spinbook.handout.comments import without_comments
from spinbook.site.repository import Repository

_FENCE = re.compile(r"^(\s*)(`{3,}|~{3,})\s*(.*)$")
_LINK = re.compile(r"(?<!!)(\[[^\]]*\]\()([^)\s]+)(\))")
_ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:|#|//", re.IGNORECASE)
_ATTRIBUTED = re.compile(r"""^(?P<language>[\w+-]+)\s.*?\btitle=["']?(?P<title>[^"'\s]+)""")

#: A mermaid drawing's code -> the HTML that shows it, in one line.
Draw = Callable[[str], str]


@dataclass(frozen=True)
class Links:
    """Where links of the text lead. `pages` maps files of the course to pages, all relative to the course."""

    pages: Mapping[str, str]
    repository: Repository

    def target(self, target: str, folder: str, page_folder: str) -> str:
        """Where a link in a file of `folder` leads, seen from a page in `page_folder`."""
        if _ELSEWHERE.match(target):
            return target
        path, mark, anchor = target.partition("#")
        full = posixpath.normpath(posixpath.join(folder, path))
        if full in self.pages:
            return posixpath.relpath(self.pages[full], page_folder or ".") + mark + anchor
        return (self.repository.link(Path(full)) or target) + mark + anchor


def rich(text: str, links: Links, folder: str, page_folder: str, draw: Draw) -> str:
    """`text`, from a file in `folder`, for a page in `page_folder`; without comments, in which authors write notes."""
    out: list[str] = []
    fence: str | None = None
    drawing: list[str] | None = None
    for line in without_comments(text, keep_lines=True).split("\n"):
        match = _FENCE.match(line)
        if match and fence is None:
            fence = match.group(2)
            if match.group(3).split(" ")[0] == "mermaid":
                drawing = []
            else:
                line = f"{match.group(1)}{fence}{_info(match.group(3))}"
        elif match and match.group(2).startswith(fence or "\0") and not match.group(3).strip():
            fence = None
            if drawing is not None:
                out += [draw("\n".join(drawing)), *[""] * (len(drawing) + 1)]
                drawing = None
                continue
        elif fence is None:
            line = _LINK.sub(lambda m: m.group(1) + links.target(m.group(2), folder, page_folder) + m.group(3), line)
        if drawing is None:
            out.append(line)
        elif match is None:
            drawing.append(line)
    if drawing is not None:
        out += ["```text", *drawing]
    return "\n".join(out)


def _info(info: str) -> str:
    """A fence's language, without the attributes that tell Spinbook what it is."""
    match = _ATTRIBUTED.match(info)
    if match:
        return match.group("language")
    return info.split(" ")[0].split("{")[0] if not info.startswith("{") else info
