"""A page of the site: its name, its source for Sphinx, the frame around it; and the files that list all pages.

The formats of sitemap and RSS: https://www.sitemaps.org/protocol.html and https://www.rssboard.org/rss-specification.
"""

from __future__ import annotations

import functools
import json
import re
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

from groundwork.child_process import run_program

_GITHUB = re.compile(r"https://github\.com/([\w.-]+)/([\w.-]+?)(?:\.git)?/?")
_GIT_LIMIT_S = 10


@dataclass(frozen=True)
class Repository:
    """A course's repository. `url` is empty if the course names none, `commit` if there is no git history."""

    root: Path
    url: str
    commit: str = ""
    date: str = ""
    """The commit's day, as in 2026-01-31."""

    @property
    def github(self) -> tuple[str, str] | None:
        """Owner and name, if the repository is on GitHub."""
        match = _GITHUB.fullmatch(self.url)
        return (match.group(1), match.group(2)) if match else None

    def link(self, file: Path, line: int | None = None) -> str:
        """Return the address of a line of a file of the course; "" if there is no repository.

        It names the last commit that changed the file. So it leads to the same line after later changes, and is the
        same when other files change. A file with uncommitted changes is linked on the main branch.
        """
        if not self.url:
            return ""
        commit = _last_commit(self.root, self.commit, file) or "main"
        # Without plain=1 GitHub renders Markdown, which has no lines.
        plain = "?plain=1" if file.suffix == ".md" and line else ""
        return f"{self.url}/blob/{commit}/{file.as_posix()}{plain}{f'#L{line}' if line else ''}"


@functools.cache  # A chapter has a link for each block of code.
def _last_commit(root: Path, head: str, file: Path) -> str:
    if not head or _git(root, "status", "--porcelain", "--", file.as_posix()):
        return ""
    return _git(root, "log", "-1", "--format=%H", "--", file.as_posix())


def repository_of(root: Path, url: str) -> Repository:
    """Return the repository of the course in `root`, from git and the address in course.toml."""
    known = _git(root, "log", "-1", "--format=%H %cs").split()
    return Repository(root, url.rstrip("/"), *known[:2])


def _git(root: Path, *words: str) -> str:
    """Return what git prints; "" if there is no git or no repository."""
    try:
        ran = run_program(["git", *words], _GIT_LIMIT_S, cwd=root)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return ran.stdout.strip() if ran.returncode == 0 else ""


_BLOB = re.compile(r"(https://github\.com/[^/]+/[^/]+)/blob/[^/]+/([^?#]+\.md)(?:[?#].*)?")


def edit_address(source: str) -> str:
    """Return the address for editing the file at `source` on GitHub; "" if it is not Markdown on GitHub."""
    match = _BLOB.fullmatch(source)
    return f"{match[1]}/edit/main/{match[2]}" if match else ""


@dataclass(frozen=True)
class Page:
    """One page. `name` is its path without a suffix, such as chapters/03-nodes-and-topics.

    `text` is a notebook or Markdown, according to `suffix`. `notebook` is the name of the notebook for readers to run.
    `about` has what the theme shows next to the text. `summary` is one sentence, for search engines and the home page.
    `runs` says whether its cells can run in the browser.
    """

    name: str
    title: str
    kind: str
    suffix: str
    text: str
    source: str = ""
    notebook: str = ""
    summary: str = ""
    about: Mapping[str, Any] = field(default_factory=dict)
    runs: bool = False

    def frame(self, openers: Mapping[str, list[dict[str, str]]]) -> str:
        """Return the values for the theme, as JSON. `openers` are the services that open a notebook, by its name."""
        return json.dumps(
            {
                "kind": self.kind,
                "source": self.source,
                "edit": edit_address(self.source),
                "notebook": self.notebook,
                "openers": openers.get(self.notebook, []),
                "summary": self.summary,
                "runs": self.runs,
                **self.about,
            },
            ensure_ascii=False,
            indent=1,
            sort_keys=True,
        )


HOME = "index"
GLOSSARY = "glossary"
ABOUT = "about"
SEARCH = "search"
NOT_FOUND = "404"

#: The suffix of the file next to a staged page, with the values for the theme.
FRAME_SUFFIX = ".frame.json"


def own_pages(site: str) -> list[str]:
    """Return the pages that consist of a template. The page for unknown addresses needs the site's address."""
    return [SEARCH, NOT_FOUND] if site else [SEARCH]


def chapter_page(name: str) -> str:
    """Return the page of the chapter of this name."""
    return f"chapters/{name}"


def exercise_page(exercise: str) -> str:
    """Return the page of an exercise."""
    return f"exercises/{exercise}"


def exercise_notebook(exercise: str) -> str:
    """Return the name of an exercise's notebook, without its suffix."""
    return f"exercise-{exercise}"


def address_of(site: str, page: str) -> str:
    """Return a page's address. That of the home page is the site's."""
    return site if page == HOME else f"{site}{page}.html"


def address_files(site: str, title: str, pages: Sequence[Page]) -> dict[str, str]:
    """Return sitemap.xml, feed.xml and robots.txt by name; none if the site's address is unknown."""
    if not site:
        return {}
    return {
        "sitemap.xml": _sitemap(site, pages),
        "feed.xml": _feed(site, title, pages),
        "robots.txt": f"User-agent: *\nAllow: /\nSitemap: {site}sitemap.xml\n",
    }


def _sitemap(site: str, pages: Sequence[Page]) -> str:
    urls = "".join(f"  <url><loc>{escape(address_of(site, page.name))}</loc></url>\n" for page in pages)
    head = '<?xml version="1.0" encoding="utf-8"?>\n<urlset xmlns="http://www.sitemaps.org/schemas/sitemap/0.9">\n'
    return f"{head}{urls}</urlset>\n"


def _feed(site: str, title: str, pages: Sequence[Page]) -> str:
    """Return the RSS feed of chapters and exercises, in reading order."""
    items = "".join(_item(site, page) for page in pages if page.kind in ("chapter", "exercise"))
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        '<rss version="2.0"><channel>\n'
        f"<title>{escape(title)}</title>\n<link>{escape(site)}</link>\n"
        f"<description>Chapters and exercises of {escape(title)}</description>\n"
        f"{items}</channel></rss>\n"
    )


def _item(site: str, page: Page) -> str:
    address = escape(address_of(site, page.name))
    summary = f"<description>{escape(page.summary)}</description>" if page.summary else ""
    return f"<item><title>{escape(page.title)}</title><link>{address}</link><guid>{address}</guid>{summary}</item>\n"
