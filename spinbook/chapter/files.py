"""Finds the files that a chapter names: images, other chapters, files to include, as each book tool would find them."""

from __future__ import annotations

import functools
import posixpath
import re
from pathlib import Path
from urllib.parse import unquote

#: Folders whose content a site's root shows (Docusaurus, VitePress, MkDocs, Jekyll, Hugo).
_SITE_FOLDERS = ("static", "docs", "public", "assets", "source", "content", "_static", "img", "images")
#: Folders at the root with files to include (Jekyll; pymdownx.snippets, in which `base_path` names it).
_INCLUDES = ("_includes", "includes", "snippets")
_ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:|//", re.IGNORECASE)
#: What may follow a link to a chapter that leaves its ending out.
_CHAPTER_ENDINGS = (".md", ".mdx", "/index.md", "/README.md", "/index.mdx", "/readme.md")


def is_elsewhere(target: str) -> bool:
    """Return whether a link leads out of the course, or stays on its page."""
    return target.startswith("#") or bool(_ELSEWHERE.match(target)) or target.startswith("attachment:")


def split(target: str) -> tuple[str, str]:
    """Return (path, anchor with its `#`) of a link; percent-encoded characters are decoded, a query is left out."""
    path, mark, anchor = target.partition("#")
    return unquote(path.partition("?")[0]), mark + anchor


@functools.lru_cache(maxsize=8192)
def locate(root: Path, folder: str, target: str) -> Path | None:
    """Return the file or folder, relative to `root`, that a link in `folder` leads to; None if there is none."""
    path, _ = split(target)
    if not path:
        return None
    path = path.removeprefix("@site/")
    if target.startswith("@site/"):
        bases = _upwards(folder)
    elif path.startswith("/"):
        path = path.lstrip("/")
        bases = [posixpath.join(base, inside) for base in _upwards(folder) for inside in ("", *_SITE_FOLDERS)]
    else:
        bases = [folder]
    places = [posixpath.join(base, path) for base in bases]
    if path.startswith("../"):
        # MkDocs and Docusaurus link to pages as if each page's own name were one more folder.
        places.append(posixpath.join(folder, path[3:]))
    inside = (full for full in map(posixpath.normpath, places) if not full.startswith(".."))
    return next(filter(None, (_file(root, full) for full in inside)), None)


def _file(root: Path, full: str) -> Path | None:
    if (root / full).is_file():
        return Path(full)
    stem = full.removesuffix(".html").rstrip("/")
    for ending in _CHAPTER_ENDINGS:
        if (root / f"{stem}{ending}").is_file():
            return Path(f"{stem}{ending}")
    return Path(full) if (root / full).exists() else None


def _upwards(folder: str) -> list[str]:
    """Return a folder and those above it, the root last."""
    parts = [part for part in folder.split("/") if part not in {"", "."}]
    return ["/".join(parts[:count]) for count in range(len(parts), -1, -1)]


def read_included(root: Path, folder: str, name: str, included: list[Path]) -> str | None:
    """Return the text of an included file, and add the file to `included`; None if it is not in the course."""
    name, _, section = name.removeprefix("@site/").partition(":")
    for place in (*_upwards(folder), *_INCLUDES):
        full = posixpath.normpath(posixpath.join(place, name.lstrip("/")))
        file = root / full
        if not full.startswith("..") and file.is_file() and file.resolve().is_relative_to(root.resolve()):
            included.append(Path(full))
            try:
                return _section(file.read_text(encoding="utf-8"), section)
            except (OSError, UnicodeDecodeError):
                return None
    return None


def _section(text: str, section: str) -> str:
    """Return the lines `FIRST:LAST` of a file, or those between `--8<-- [start:NAME]` and `[end:NAME]`."""
    lines = text.split("\n")
    first, _, last = section.partition(":")
    if first.isdigit() or last.isdigit():
        return "\n".join(lines[int(first or 1) - 1 : int(last) if last.isdigit() else None])
    if section and any(f"[start:{section}]" in line for line in lines):
        start = next(i for i, line in enumerate(lines) if f"[start:{section}]" in line)
        end = next((i for i, line in enumerate(lines) if f"[end:{section}]" in line), len(lines))
        return "\n".join(lines[start + 1 : end])
    return text
