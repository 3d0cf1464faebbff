"""Writes what Sphinx reads into a folder that holds only what may be published."""

from __future__ import annotations

from pathlib import Path

from spinbook.site.contents import Contents
from spinbook.site.names import FRAME_SUFFIX, HOME
from spinbook.written import write_if_changed


def stage(contents: Contents, folder: Path) -> None:
    """Make `folder` hold the pages, and nothing else. Files that are as they should be keep their times."""
    wanted: dict[Path, str | bytes] = {folder / path: data for path, data in contents.pictures.items()}
    for page in contents.pages:
        wanted[folder / f"{page.name}{page.suffix}"] = page.text + (_table_of(contents) if page.name == HOME else "")
        wanted[folder / f"{page.name}{FRAME_SUFFIX}"] = page.frame(contents.openers)
    for file, content in wanted.items():
        write_if_changed(file, content)
    for file in folder.rglob("*"):
        if file.is_file() and file not in wanted:
            file.unlink()


def _table_of(contents: Contents) -> str:
    """Sphinx learns the order of the pages from it; the theme shows it its own way."""
    pages = "\n".join(page.name for page in contents.pages if page.name != HOME)
    return f"\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n"
