"""Puts the finished site into its folder: the pages, and the files that they use. Nothing else gets there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from spinbook.written import write_if_changed

#: What is taken from Sphinx's output.
_IMAGES = "_images"
_OURS = ("early.js", "site.js", "run.js", "search.js", "site.css", "print.css", "icon.svg", "search-data.js")


def publish(html: Path, pages: Iterable[str], files: Mapping[str, str | bytes], site: Path) -> int:
    """Make `site` hold these `pages` of `html` and these `files`: path -> content. Returns how many files it holds."""
    wanted = {Path(f"{page}.html"): (html / f"{page}.html").read_bytes() for page in pages}
    used = b"\n".join(wanted.values())
    for image in (html / _IMAGES).glob("*"):
        # Sphinx keeps pictures of earlier builds.
        if image.name.encode() in used:
            wanted[image.relative_to(html)] = image.read_bytes()
    for name in _OURS:
        wanted[Path("_static", name)] = (html / "_static" / name).read_bytes()
    for path, content in files.items():
        wanted[Path(path)] = content.encode("utf-8") if isinstance(content, str) else content
    # Pages of GitHub would leave out folders that begin with an underscore.
    wanted[Path(".nojekyll")] = b""
    for relative, data in wanted.items():
        write_if_changed(site / relative, data)
    _remove_others(site, set(wanted))
    return len(wanted)


def _remove_others(site: Path, wanted: set[Path]) -> None:
    for file in sorted(site.rglob("*"), reverse=True):
        if file.is_file() and file.relative_to(site) not in wanted:
            file.unlink()
        elif file.is_dir() and not any(file.iterdir()):
            file.rmdir()
