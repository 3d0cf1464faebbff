"""Makes a chapter's prose into Markdown that JupyterLab, VS Code and Colab show without extensions."""

from __future__ import annotations

import posixpath
import re

_ALERT = re.compile(r"^(\s*>\s*)\[!(NOTE|TIP|IMPORTANT|WARNING|CAUTION)\]\s*$", re.IGNORECASE)
_ADMONITION = re.compile(r"^(:{3,})\s*\{?(\w+)\}?\s*(.*)$")
_FENCE = re.compile(r"^(\s*)(`{3,}|~{3,})(.*)$")
_LINK = re.compile(r"(!?\[[^\]]*\]\()([^)\s]+)(\))")


def portable(prose: str, chapter_folder: str, repository: str) -> str:
    """The prose with alerts and admonitions as quotations, plain fences, and links that lead somewhere.

    `chapter_folder` is relative to the course; links to files of the course are made to point into `repository`
    (a URL without a slash at its end), those to other chapters to their notebooks.
    """
    out: list[str] = []
    fence: str | None = None
    admonition: str | None = None
    for line in prose.split("\n"):
        if match := _FENCE.match(line):
            _, mark, info = match.groups()
            if fence is None:
                fence = mark
                line = _plain_opening(line, info)
            elif mark.startswith(fence) and not info.strip():
                fence = None
        elif fence is None:
            if admonition is None and (opened := _ADMONITION.match(line)):
                admonition = opened.group(1)
                title = opened.group(3) or opened.group(2).capitalize()
                out += [f"> **{title}**", ">"]
                continue
            if admonition is not None and line.strip() == admonition:
                admonition = None
                continue
            if alert := _ALERT.match(line):
                out += [f"{alert.group(1)}**{alert.group(2).capitalize()}**", alert.group(1).rstrip()]
                continue
            line = _LINK.sub(lambda m: m.group(1) + _target(m.group(2), chapter_folder, repository) + m.group(3), line)
        out.append(f"> {line}".rstrip() if admonition is not None else line)
    return "\n".join(out)


def _plain_opening(line: str, info: str) -> str:
    """An opening fence without attributes, its file name in a line above it."""
    title = re.search(r"""title=["']([^"']+)["']""", info)
    language = info.strip().split(" ")[0].split("{")[0]
    plain = line[: len(line) - len(info)] + language
    return f"`{title.group(1)}`:\n\n{plain}" if title else plain


def _target(target: str, chapter_folder: str, repository: str) -> str:
    if re.match(r"[a-z][a-z0-9+.-]*:|#|//", target, re.IGNORECASE):
        return target
    path, hash_mark, anchor = target.partition("#")
    if posixpath.dirname(path) in {"", "."} and path.endswith(".md"):
        return f"{path.removesuffix('.md')}.ipynb{hash_mark}{anchor}"
    if not repository:
        return target
    full = posixpath.normpath(posixpath.join(chapter_folder, path))
    return f"{repository}/blob/main/{full}{hash_mark}{anchor}"
