"""Finds the Markdown files of a book by the names in its table of contents."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Iterator
from glob import glob
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import yaml

from spinbook.chapter.source import read_source

#: Files that become Markdown chapters.
CONVERTED = (".ipynb", ".rst")
_MARKDOWN = (".md", ".mdx", ".qmd", ".markdown")
ENDINGS = (*_MARKDOWN, *CONVERTED)
#: Folders without chapters.
_SKIPPED = frozenset(
    {"node_modules", "build", "blog", "i18n", "versioned_docs", "vendor", "site", "_site", "dist", "venv"}
    | {"_includes", "_layouts", "_sass", "_data", "_drafts", "_templates", "__pycache__"}
)
#: Files about a repository, not of a book.
_NOT_CHAPTERS = frozenset(
    {"contributing", "changelog", "license", "code_of_conduct", "security", "summary"}
    | {"claude", "agents", "gemini", "authors", "pull_request_template"}
)
_NUMBER = re.compile(r"^\d+\s*[-_.]+\s*(?=.)")


class Pages:
    """The pages below `root`."""

    def __init__(self, root: Path) -> None:
        self._root = root

    def find(self, folder: Path, name: str) -> Path | None:
        """Return the file that a table of contents in `folder` calls `name`, with or without its suffix or number."""
        name = unquote(name.strip().split("?")[0]).strip("/")
        for base in (folder, self._root):
            path = base / name
            for candidate in (path, *(path.with_name(path.name + ending) for ending in ENDINGS)):
                if candidate.is_file() and candidate.suffix in ENDINGS and self._is_inside(candidate):
                    return candidate.resolve()
            for index in ("index.md", "README.md", "index.mdx", "index.rst"):
                if (path / index).is_file() and self._is_inside(path):
                    return (path / index).resolve()
        return self._by_id(folder).get(name)

    def find_all(self, folder: Path, name: str) -> list[Path]:
        """Return the file of this name, or, for a pattern such as `more/*.md`, all that match it."""
        if "*" not in name:
            return [file] if (file := self.find(folder, name)) else []
        names = glob(name, root_dir=folder, recursive=True)  # noqa: PTH207  # Path's raises for some patterns
        matches = sorted(map(folder.joinpath, names), key=self._place)
        return [file.resolve() for file in matches if file.suffix in ENDINGS and self._is_inside(file)]

    def _is_inside(self, path: Path) -> bool:
        return path.resolve().is_relative_to(self._root)

    @functools.cache  # noqa: B019
    def _by_id(self, folder: Path) -> dict[str, Path]:
        """Return the files by Docusaurus's ids: the path without suffix and numbers, with the front matter's `id`."""
        found: dict[str, Path] = {}
        for file in self.in_folder(folder):
            parts = [_NUMBER.sub("", part) for part in file.relative_to(folder.resolve()).with_suffix("").parts]
            found.setdefault("/".join(parts), file)
            if own := self._front_matter(file).get("id"):
                found.setdefault("/".join([*parts[:-1], str(own)]), file)
        return found

    def in_folder(self, folder: Path) -> Iterator[Path]:
        """Yield the chapters below a folder, in the order of their front matter or their names."""
        if not folder.is_dir():
            return
        entries = [entry for entry in folder.resolve().iterdir() if self._is_wanted(entry)]
        for entry in _listed(folder.resolve(), sorted(entries, key=self._place)):
            if entry.is_dir():
                yield from self.in_folder(entry)
            else:
                yield entry

    def by_parents(self, folder: Path) -> list[Path]:
        """Return the chapters below a folder; with Jekyll's `parent` in the front matter, each after its parent."""
        files = list(self.in_folder(folder))
        parents = {file: str(self._front_matter(file).get("parent") or "") for file in files}
        titles = {str(self._front_matter(file).get("title") or ""): file for file in reversed(files)}
        below: dict[Path | None, list[Path]] = {}
        for file in sorted(files, key=lambda file: self._place(file)[0]) if any(parents.values()) else files:
            parent = titles.get(parents[file])
            below.setdefault(parent if parent != file else None, []).append(file)
        ordered = _descended(below, None)
        return [*ordered, *(file for file in files if file not in ordered)]

    def _is_wanted(self, entry: Path) -> bool:
        if entry.name.startswith(".") or entry.name in _SKIPPED:
            return False
        if not entry.is_dir() and self._front_matter(entry).get("draft") is True:
            return False
        if entry.is_dir():
            return not (entry / "course.toml").exists()
        is_root_readme = (
            entry.parent == self._root and entry.stem.lower() == "readme" and (self._root / "docs").is_dir()
        )
        if entry.suffix in CONVERTED and any(entry.with_suffix(ending).is_file() for ending in _MARKDOWN):
            # A notebook beside its Markdown, as jupytext keeps them.
            return False
        # Docusaurus and Quarto include files whose names begin with `_`; Hugo's `_index.md` is a page.
        is_part = entry.stem.startswith("_") and entry.stem != "_index"
        is_chapter = entry.suffix in ENDINGS and entry.stem.lower() not in _NOT_CHAPTERS
        return is_chapter and not is_root_readme and not is_part

    def _place(self, entry: Path) -> tuple[float, bool, list[tuple[int, str]]]:
        first = entry.stem.lower() in {"index", "readme", "intro", "introduction"} and entry.is_file()
        position = self._position(entry)
        return (position if position is not None else 0.0 if first else float("inf"), not first, _natural(entry.name))

    def _position(self, entry: Path) -> float | None:
        if entry.is_dir():
            about = _category(entry)
            index = next((entry / name for name in ("index.md", "index.mdx") if (entry / name).is_file()), None)
            about = about or (self._front_matter(index) if index else {})
        else:
            about = self._front_matter(entry)
        sidebar = about.get("sidebar")
        about = {**(sidebar if isinstance(sidebar, dict) else {}), **about}
        for key in ("position", "sidebar_position", "nav_order", "weight", "order", "sort"):
            try:
                return float(about[key])
            except (KeyError, TypeError, ValueError):
                continue
        return None

    @functools.cache  # noqa: B019
    def _front_matter(self, file: Path) -> dict[str, Any]:
        source, _ = read_source(file, file) if file.suffix in _MARKDOWN else (None, [])
        return dict(source.front_matter) if source else {}

    def title_of(self, file: Path) -> str:
        """Return the title of a page, or its folder's name in words."""
        return str(self._front_matter(file).get("title") or self._root.name.replace("-", " ").replace("_", " "))


def _descended(below: dict[Path | None, list[Path]], parent: Path | None) -> list[Path]:
    """Return the pages below a page, each followed by those below it."""
    pages = below.pop(parent, [])
    return [item for page in pages for item in (page, *_descended(below, page))]


def _listed(folder: Path, entries: list[Path]) -> list[Path]:
    """Return the entries in the order of the folder's `.pages`, where `...` means the rest. Without one, return all.

    A folder that is not listed but has the name of a page, such as `part1/` of `part1.md`, comes after that page.
    """
    try:
        about = yaml.safe_load((folder / ".pages").read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return entries
    nav = (about.get("nav") or about.get("arrange")) if isinstance(about, dict) else None
    if not isinstance(nav, list):
        return entries
    named = [str(next(iter(item.values()), "")) if isinstance(item, dict) else str(item) for item in nav]
    by_name = {entry.name: entry for entry in entries}
    rest = [entry for entry in entries if entry.name not in named]
    found: dict[Path, None] = {}
    for name in named:
        group = [by_name[name]] if name in by_name else rest if name.startswith("...") else []
        stems = {entry.stem for entry in group if entry.is_file()}
        found |= dict.fromkeys([*group, *(entry for entry in rest if entry.is_dir() and entry.name in stems)])
    return [*found] or entries


def _category(folder: Path) -> dict[str, Any]:
    try:
        about = json.loads((folder / "_category_.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return about if isinstance(about, dict) else {}


def _natural(name: str) -> list[tuple[int, str]]:
    """Return a sort key that puts `2.md` before `10.md`."""
    return [(int(part), "") if part.isdigit() else (-1, part.lower()) for part in re.split(r"(\d+)", name)]
