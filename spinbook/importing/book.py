"""Reads the settings of an existing book: its title, its chapters and their order."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from markdown_it import MarkdownIt

from groundwork.problem import Problem
from spinbook.importing.javascript import objects_in, value_in
from spinbook.importing.pages import ENDINGS, Pages
from spinbook.importing.toctree import pages_below
from spinbook.problem import SpinbookError

#: Texts that Spinbook does not read, and pandoc does.
_OTHER_TEXTS = frozenset({".adoc", ".docx", ".html", ".odt", ".org", ".tex", ".textile", ".wiki"})


@dataclass(frozen=True)
class Book:
    """An existing book. `root` is the folder that becomes the course; `chapters` are relative to it, in order.

    `contents` is the file that defines the order, None if there is none. `left_out` are listed pages that do not exist
    or that Spinbook does not read, `unlisted` are pages that it does not list.
    """

    root: Path
    title: str
    chapters: tuple[Path, ...]
    contents: Path | None
    left_out: tuple[str, ...] = ()
    repository: str = ""
    unlisted: tuple[Path, ...] = ()


class _Yaml(yaml.SafeLoader):
    """YAML with the tags of other tools, such as `!ENV` and `!!python/name`, read as nothing."""


_Yaml.add_multi_constructor("", lambda loader, suffix, node: None)


def read_book(path: Path) -> Book:
    """Read the book at `path`: a folder, or the file that defines its order. Raises SpinbookError."""
    path = path.resolve()
    if not path.exists():
        raise SpinbookError(Problem(path, None, "there is no such file or folder.", "Name a book's folder."))
    contents = path if path.is_file() else _contents_in(path)
    root = _root(path, contents)
    pages = Pages(root)
    if contents is None:
        return _book(root, pages, None, "", root, [*pages.by_parents(root)])
    reader = next((read for name, read in _READERS.items() if contents.name.startswith(name)), None)
    if reader is None:
        found = "this file does not list the chapters of a book."
        raise SpinbookError(Problem(contents, None, found, f"Known are: {', '.join(_READERS)}."))
    title, folder, listed = reader(contents, pages)
    return _book(root, pages, contents, title, folder, listed)


def _contents_in(folder: Path) -> Path | None:
    """Return the file that defines the order, in a folder or one below it; None if there is none."""
    for below in ("", "docs", "website", "book", "doc", "source", "src", "content", "docs/source", "doc/source"):
        for name in _READERS:
            found = sorted(path for path in (folder / below).glob(f"{name}*") if path.is_file())
            if found:
                return found[0]
    return None


def _root(path: Path, contents: Path | None) -> Path:
    """Return the folder of the whole book: `path` itself, or the repository of the file at `path`."""
    if path.is_dir():
        return path
    assert contents is not None
    folder = contents.parent
    above = [folder, *folder.parents][:4]
    return next((path for path in above if (path / ".git").exists()), folder)


def _book(root: Path, pages: Pages, contents: Path | None, title: str, folder: Path, listed: list[str | Path]) -> Book:
    chapters: dict[Path, None] = {}
    left_out: list[str] = []
    for item in listed:
        found = [item] if isinstance(item, Path) else pages.find_all(folder, item)
        left_out += [] if found else [str(item)]
        chapters |= {file.relative_to(root): None for file in found}
    if not chapters and left_out and contents:
        why = f"none of the pages that it lists is there: {', '.join(left_out)}."
        raise SpinbookError(Problem(contents, None, why, f"Their paths are relative to {folder}."))
    if not chapters:
        raise SpinbookError(_nothing_in(root))
    title = title or _title_of(root) or pages.title_of(root / next(iter(chapters)))
    unlisted = [page.relative_to(root) for page in pages.in_folder(folder)] if contents else []
    unlisted = [page for page in unlisted if page not in chapters]
    return Book(root, title, tuple(chapters), contents, tuple(left_out), _repository(root), tuple(unlisted))


def _nothing_in(root: Path) -> Problem:
    """Return what is wrong with a folder without chapters, and what to do with what is there."""
    suffixes = Counter(path.suffix for path in root.rglob("*") if path.is_file() and path.suffix in _OTHER_TEXTS)
    read = ", ".join(ENDINGS)
    if suffixes:
        there = ", ".join(f"{count} {suffix}" for suffix, count in suffixes.most_common())
        example = f"pandoc chapter{suffixes.most_common()[0][0]} -o chapter.md"
        return Problem(root, None, f"there are no chapters here, but: {there}.", f"Convert them, such as: {example}")
    return Problem(root, None, f"there are no chapters here ({read}).", "Name their folder: spinbook import FOLDER")


def _mkdocs(file: Path, pages: Pages) -> tuple[str, Path, list[str | Path]]:
    data = _load(file)
    folder = file.parent / str(data.get("docs_dir") or "docs")
    nav = data.get("nav")
    listed: list[str | Path] = list(_strings(nav)) if nav else list(pages.in_folder(folder))
    return str(data.get("site_name") or ""), folder, listed


def _jupyter_book(file: Path, pages: Pages) -> tuple[str, Path, list[str | Path]]:
    data = _load(file)
    config = file.with_name("_config.yml")
    title = str(_load(config).get("title") or "") if config.is_file() else ""
    return title, file.parent, list(_under(data, ("root", "file", "glob")))


def _myst(file: Path, pages: Pages) -> tuple[str, Path, list[str | Path]]:
    project = _load(file).get("project") or {}
    listed = list(_under(project.get("toc"), ("file", "pattern")))
    if not listed and file.with_name("_toc.yml").is_file():
        return str(project.get("title") or ""), *_jupyter_book(file.with_name("_toc.yml"), pages)[1:]
    return str(project.get("title") or ""), file.parent, [*listed] if listed else list(pages.in_folder(file.parent))


def _quarto(file: Path, pages: Pages) -> tuple[str, Path, list[str | Path]]:
    data = _load(file)
    book = data.get("book") or data.get("website") or {}
    listed = [*_strings(book.get("chapters")), *_strings(book.get("sidebar")), *_strings(book.get("appendices"))]
    known = [name for name in listed if name.endswith((".md", ".qmd", ".mdx"))]
    return str(book.get("title") or ""), file.parent, [*known] if known else list(pages.in_folder(file.parent))


def _docusaurus(file: Path, pages: Pages) -> tuple[str, Path, list[str | Path]]:
    folder = file.parent / "docs" if (file.parent / "docs").is_dir() else file.parent
    listed: list[str | Path] = []
    for sidebars in objects_in(file.read_text(encoding="utf-8", errors="replace")):
        for sidebar in sidebars.values() if isinstance(sidebars, dict) else ():
            listed += _items(sidebar, folder, pages)
    return "", folder, listed or list(pages.in_folder(folder))


def _items(item: Any, folder: Path, pages: Pages) -> Iterator[str | Path]:
    """Yield the pages of a Docusaurus sidebar."""
    if isinstance(item, str):
        yield item
    elif isinstance(item, list):
        for inner in item:
            yield from _items(inner, folder, pages)
    elif isinstance(item, dict) and item.get("type") == "autogenerated":
        yield from pages.in_folder(folder / str(item.get("dirName", ".")))
    elif isinstance(item, dict):
        if item.get("type") in {"doc", "ref"} and isinstance(item.get("id"), str):
            yield item["id"]
        if isinstance(item.get("link"), dict) and item["link"].get("type") == "doc":
            yield str(item["link"].get("id", ""))
        if "items" in item:
            yield from _items(item["items"], folder, pages)
        elif "type" not in item:
            # The short form: { "A category": ["one", "two"] }.
            yield from _items(list(item.values()), folder, pages)


def _starlight(file: Path, pages: Pages) -> tuple[str, Path, list[str | Path]]:
    """Read astro.config.*: the title and the `sidebar` of Starlight. The file is read, never run."""
    text = file.read_text(encoding="utf-8", errors="replace")
    places = (file.parent / "src/content/docs", file.parent / "docs")
    folder = next((path for path in places if path.is_dir()), file.parent)
    start = re.search(r"\bsidebar\s*:\s*(?=\[)", text)
    sidebar = value_in(text[start.end() :]) if start else []
    title = re.search(r"""starlight\(\{.*?\btitle\s*:\s*(["'`])(.+?)\1""", text, re.DOTALL)
    listed = [item for entry in sidebar or [] for item in _sidebar_items(entry, folder, pages)]
    return title[2] if title else "", folder, listed or list(pages.in_folder(folder))


def _sidebar_items(item: Any, folder: Path, pages: Pages) -> Iterator[str | Path]:
    """Yield the pages of an entry in Starlight's sidebar."""
    if isinstance(item, str):
        yield item
    if not isinstance(item, dict):
        return
    if isinstance(item.get("autogenerate"), dict):
        yield from pages.in_folder(folder / str(item["autogenerate"].get("directory", ".")))
    link = item.get("slug") or item.get("link")
    if isinstance(link, str) and "://" not in link:
        yield link.partition("#")[0]
    for inner in item.get("items") or ():
        yield from _sidebar_items(inner, folder, pages)


def _sphinx(file: Path, pages: Pages) -> tuple[str, Path, list[str | Path]]:
    """Read the `project` of Sphinx's conf.py, which is never run, and the toctrees from the index on."""
    title = re.search(
        r"""^project\s*=\s*(["'])(.+?)\1""", file.read_text(encoding="utf-8", errors="replace"), re.MULTILINE
    )
    index = pages.find(file.parent, "index") or pages.find(file.parent, "contents")
    listed = list(dict.fromkeys(pages_below(index, file.parent, pages, set()))) if index else []
    return title[2] if title else "", file.parent, [*listed] if listed else list(pages.in_folder(file.parent))


def _list_of_links(file: Path, pages: Pages) -> tuple[str, Path, list[str | Path]]:
    tokens = MarkdownIt("commonmark").parse(file.read_text(encoding="utf-8", errors="replace"))
    targets = [str(child.attrs.get("href", "")) for token in tokens for child in token.children or []]
    listed = [target.partition("#")[0] for target in targets if target and "://" not in target]
    return "", file.parent, [target for target in listed if target]


_Reader = Callable[[Path, Pages], tuple[str, Path, list[str | Path]]]
#: The first part of the name of a file that defines the order -> the function that reads it.
_READERS: dict[str, _Reader] = {
    "mkdocs.y": _mkdocs,
    "_toc.yml": _jupyter_book,
    "myst.yml": _myst,
    "_quarto.yml": _quarto,
    "sidebars.": _docusaurus,
    "astro.config.": _starlight,
    "SUMMARY.md": _list_of_links,
    "_sidebar.md": _list_of_links,
    "conf.py": _sphinx,
}


def _load(file: Path) -> dict[str, Any]:
    try:
        data = yaml.load(file.read_text(encoding="utf-8"), Loader=_Yaml)
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        words = str(getattr(error, "problem", None) or error)
        raise SpinbookError(Problem(file, None, f"it can't be read: {words}.", "Save it as YAML.")) from None
    # The first form of _toc.yml is a list.
    return data if isinstance(data, dict) else {"chapters": data or []}


def _strings(value: Any) -> Iterator[str]:
    """Yield every page in nested lists and `Title: page` pairs."""
    if isinstance(value, str):
        if "://" not in value:
            yield value
    elif isinstance(value, Iterable):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _strings(item)


def _under(value: Any, keys: tuple[str, ...]) -> Iterator[str]:
    """Yield the strings under these keys at any depth, in order."""
    if isinstance(value, dict):
        for key, item in value.items():
            if key in keys and isinstance(item, str):
                yield item
            else:
                yield from _under(item, keys)
    elif isinstance(value, list):
        for item in value:
            yield from _under(item, keys)


def _title_of(root: Path) -> str:
    """Return the title in the book's settings; "" if there is none."""
    for name in ("_config.yml", "docs/_config.yml"):
        if (root / name).is_file() and (title := _load(root / name).get("title")):
            return str(title)
    texts = (file.read_text(encoding="utf-8", errors="replace") for file in root.glob("docusaurus.config.[jt]s"))
    titles = (re.search(r"""\btitle:\s*(["'`])(.+?)\1""", text) for text in texts)
    return next((match[2] for match in titles if match), "")


def _repository(root: Path) -> str:
    """Return the address of the repository on GitHub, from the clone's settings; "" if there is none."""
    for folder in (root, *root.parents):
        config = folder / ".git" / "config"
        if config.is_file():
            match = re.search(
                r"github\.com[:/]([\w.-]+/[\w.-]+?)(?:\.git)?\s*$", config.read_text(errors="replace"), re.MULTILINE
            )
            # A course below the repository's root has other paths than the repository.
            return f"https://github.com/{match[1]}" if match and folder == root else ""
    return ""
