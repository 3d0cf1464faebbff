"""Stages the pages, runs Sphinx on them, and publishes the site, after making sure that it reveals no secret."""

from __future__ import annotations

import json
import logging
import re
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping
from io import StringIO
from itertools import chain
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.errors import SphinxError

from grader.exercise.loading import load
from groundwork.files import write_folder
from groundwork.problem import Problem, Severity
from spinbook.browser.files import FILES, FOLDER, run_version
from spinbook.build.digest import digest
from spinbook.course.course import Course
from spinbook.handout.leaks import authors_code, leaks, secrets_of_all
from spinbook.problem import SpinbookError
from spinbook.site.contents import SiteContents
from spinbook.site.extension import NAME
from spinbook.site.page import FRAME_SUFFIX, HOME, NOT_FOUND, own_pages

#: The pictures, linked files and other files of Sphinx's output that are published.
_COPIED = ("_images/*", "_downloads/*/*")
_SEARCH_DATA = "search-data.js"
_OURS = ("early.js", "site.js", "run.js", "search.js", "site.css", "print.css", "icon.svg", _SEARCH_DATA)


def publish(html: Path, pages: Iterable[str], files: Mapping[str, str | bytes], site: Path, address: str) -> int:
    """Make `site` consist of these `pages` of `html` and these `files`: path -> content. Return the number of files.

    `address` is where the site will be published, "" if that is unknown.
    """
    scripts = {name: (html / "_static" / name).read_bytes() for name in _OURS}
    # The search data changes with every sentence: it is no reason to load the rest again.
    own = [data for path, data in files.items() if Path(path).parent.name == "_static"]
    version = digest(run_version(files), *own, *(data for name, data in scripts.items() if name != _SEARCH_DATA))[:16]
    # Pages load our scripts and styles by addresses with this version: no cache gives them older ones.
    stamp = rb"\1?v=" + version.encode() + b'"'
    published = {f"{page}.html": _OWN_FILE.sub(stamp, (html / f"{page}.html").read_bytes()) for page in pages}
    if (lost := f"{NOT_FOUND}.html") in published:
        # Servers show this page at any address.
        published[lost] = _RELATIVE.sub(rb'\1="' + address.encode() + rb'\2"', published[lost])
    used = b"\n".join(published.values())
    for file in chain.from_iterable(map(html.glob, _COPIED)):
        # Sphinx keeps files of earlier builds: skip those that no page uses.
        if (path := file.relative_to(html).as_posix()).encode() in used:
            published[path] = file.read_bytes()
    published |= {f"_static/{name}": data for name, data in scripts.items()}
    published |= {path: data.encode() if isinstance(data, str) else data for path, data in files.items()}
    published[_VERSION] = version.encode()
    published[_OFFLINE] = _for_offline(published)
    # Without this file, GitHub Pages leaves out folders that begin with an underscore.
    published[".nojekyll"] = b""
    write_folder(site, {path: _bare(Path(path), data) for path, data in published.items()})
    return len(published)


#: For pages that are open while the course is updated; and what a page keeps for reading without a network.
_VERSION, _OFFLINE = "version.txt", "offline.json"
_RELATIVE = re.compile(rb'\b(href|src|action|data-root)="(?!https?:|#|\./)([^"]*)"')
_OWN_FILE = re.compile(rb'(_static/(?:%s))"' % b"|".join(re.escape(name.encode()) for name in _OURS))


_COMMENTS = re.compile(rb"^[ \t]*(?://[^\n]*\n|/\*.*?\*/\n)?", re.MULTILINE | re.DOTALL)

_CSS_SPARE = re.compile(rb"(?:\s|;(?=\s*}))*([{};,>])\s*|(?<=:)\s+|(?<![\w.])0(?=\.\d)")


def _bare(file: Path, code: bytes) -> bytes:
    """Return a page's script or style sheet without what no browser needs: indentation, and comments on lines of their
    own; in a style sheet also spaces, last semicolons, and zeros before a decimal point."""
    if file.parent.name != "_static":
        return code
    code = _COMMENTS.sub(b"", code)
    return _CSS_SPARE.sub(rb"\1", code) if file.suffix == ".css" else code


def _for_offline(published: Mapping[str, bytes]) -> bytes:
    """Return the pages, pictures and downloads of a site, each with a digest of its content."""
    read = sorted((Path(path), data) for path, data in published.items() if not path.startswith(f"{FOLDER}/"))
    kept = ((path, data) for path, data in read if path.suffix == ".html" or len(path.parts) > 1)
    return json.dumps({path.as_posix(): digest(data)[:16] for path, data in kept}).encode()


def stage(contents: SiteContents, folder: Path) -> None:
    """Make `folder` consist of the pages. Unchanged files are not written, so that Sphinx skips them."""
    staged: dict[str, str | bytes] = {**contents.pictures}
    for page in contents.pages:
        staged[f"{page.name}{page.suffix}"] = page.text + (_table_of(contents) if page.name == HOME else "")
        staged[f"{page.name}{FRAME_SUFFIX}"] = page.frame(contents.openers)
    write_folder(folder, staged)


def _table_of(contents: SiteContents) -> str:
    """Return the table of contents, which gives Sphinx the order of the pages. The theme shows its own."""
    pages = "\n".join(page.name for page in contents.pages if page.name != HOME)
    return f"\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n"


_FIX = (
    "Students must not see it. Take it out of the chapter, the task or the public checks. A line of the solution that "
    "they may see belongs before # BEGIN SOLUTION."
)


def prove_nothing_leaks(course: Course, contents: SiteContents) -> None:
    """Raise SpinbookError if the site would reveal a solution, a hidden check or a scenario of any exercise.

    This searches the sources of the pages, because HTML has markup in every line of code.
    """
    exercises = [load(course.root / "exercises" / name) for name in sorted(course.exercises)]
    taught = "\n".join([*contents.taught, authors_code(contents.copies)])
    known, names = secrets_of_all(exercises, taught)
    leaked: dict[Path, str] = {}
    for file, secret in leaks(_published(contents), known + names):
        page = file.removesuffix(".frame").partition(".")[0]
        leaked.setdefault(contents.origins.get(page, Path("build", file)), secret)
    if leaked:
        problems = (Problem(file, None, f"{secret} would be published.", _FIX) for file, secret in leaked.items())
        raise SpinbookError(*problems)


def _published(contents: SiteContents) -> dict[str, bytes]:
    files: dict[str, str | bytes] = {f"{page.name}{page.suffix}": page.text for page in contents.pages}
    files |= {f"{page.name}.frame": page.frame(contents.openers) for page in contents.pages}
    others = {f"{FOLDER}/{name}" for name in FILES}  # of Pyodide: large, with nothing of a course
    files |= {f"site/{path}": content for path, content in contents.files.items() if path not in others}
    files |= {f"launch/{path}": content for path, content in contents.branch.items()}
    # In the notebooks they are compressed, where nothing could be found.
    files |= {f"launch/{path}": content for path, content in contents.copies.items()}
    return {path: content.encode() if isinstance(content, str) else content for path, content in files.items()}


_THEMES = Path(__file__).parent
_WARNING = re.compile(r"^(?P<file>/.*?):(?:(?P<line>\d+):)? (?:WARNING|ERROR|CRITICAL): (?P<what>.*)$")
#: Warnings of docutils about a line `---` between sections, which is shown correctly nevertheless.
_NO_MATTER = re.compile(r"[Tt]ransition(s)? (must|are)|(begin|end) with a transition|separate transitions")
_ANSI = re.compile(r"\x1b\[[0-9;]*m")
#: myst-nb counts the lines of each cell from this many times the cell's number.
_LINES_PER_CELL = 10_000


def run_sphinx(
    contents: SiteContents, source: Path, cache: Path, course: Course, on_page: Callable[[str], None]
) -> tuple[Path, list[Problem]]:
    """Make the pages in `cache / "html"` from the staged folder `source`. Return that folder, and what to fix.

    Unchanged pages are not rebuilt. Raises SpinbookError if Sphinx can't continue.
    """
    output = cache / "html"
    text = StringIO()
    try:
        app = Sphinx(
            srcdir=source,
            confdir=None,
            outdir=output,
            doctreedir=cache / "doctrees",
            buildername="html",
            confoverrides=_settings(contents, course),
            status=None,
            warning=text,
            parallel=1,
        )
        app.connect("html-page-context", lambda app, page, *rest: on_page(page))
        app.build()
    except Exception as error:
        # The cache may be what is broken: the next build starts without it.
        shutil.rmtree(cache / "doctrees", ignore_errors=True)
        words = str(error).strip().splitlines()
        problem = f"the pages could not be made: {words[-1] if words else type(error).__name__}"
        is_authors = isinstance(error, SphinxError)
        fix = "Check your last changes." if is_authors else "This is a bug in Spinbook: please report it."
        raise SpinbookError(
            *_problems(text.getvalue(), contents, source), Problem(source, None, problem, fix)
        ) from None
    finally:
        _close_handlers()
    return output, list(_problems(text.getvalue(), contents, source))


def _settings(contents: SiteContents, course: Course) -> dict[str, Any]:
    terms = [(form, term.anchor) for term in contents.terms for form in term.forms]
    nav = [
        {"page": page.name, "title": page.title, "kind": page.kind, "week": page.about.get("week", "")}
        for page in contents.pages
        if page.name != HOME
    ]
    return {
        "project": course.title,
        "language": "en",
        "extensions": ["myst_nb", NAME],
        "exclude_patterns": [],
        "nb_execution_mode": "off",
        "nb_merge_streams": True,
        "nb_render_text_lexer": "ros-log",
        "nb_render_error_lexer": "ros-log",
        "myst_enable_extensions": ["alert", "colon_fence", "deflist", "dollarmath", "strikethrough", "tasklist"],
        "myst_heading_anchors": 6,
        "myst_all_links_external": False,
        "html_theme": "theme",
        "html_theme_path": [str(_THEMES)],
        "html_title": course.title,
        "html_math_renderer": "mathml",
        "html_copy_source": False,
        "html_show_sourcelink": False,
        "html_use_index": False,
        "html_permalinks_icon": "#",
        "html_additional_pages": {name: f"{name}.html" for name in own_pages(course.site)},
        "html_context": {
            "nav": nav,
            "repository": course.repository,
            "site": course.site,
            "package": course.package.name,
        },
        "spinbook_terms": terms,
        "suppress_warnings": ["misc.highlighting_failure", "myst.xref_missing_ignored", "myst.strikethrough"],
    }


def _problems(text: str, contents: SiteContents, source: Path) -> Iterator[Problem]:
    seen: set[str] = set()
    for line in _ANSI.sub("", text).splitlines():
        match = _WARNING.match(line)
        if match is None or line in seen or _NO_MATTER.search(line):
            continue
        seen.add(line)
        file, number = _place(match.group("file"), match.group("line"), contents, source)
        problem = re.sub(r"\s*\[[\w.-]+\]$", "", match.group("what"))
        yield Problem(file, number, problem, "The page shows it as well as possible.", Severity.WARNING)


def _place(file: str, line: str | None, contents: SiteContents, source: Path) -> tuple[Path, int | None]:
    """Return the author's file and line for a line in a staged page."""
    try:
        page = Path(file).relative_to(source.resolve()).with_suffix("").as_posix()
    except ValueError:
        return Path(file), int(line) if line else None
    origin = contents.origins.get(page, Path(f"{page}.md"))
    if line is None:
        return origin, None
    number = int(line)
    starts = contents.lines.get(page)
    if starts is None:
        return origin, number
    cell, within = divmod(number, _LINES_PER_CELL)
    # myst-nb counts a cell's lines from 1, and MyST's parser adds one more.
    return origin, starts[min(cell, len(starts)) - 1] + max(within - 2, 0) if cell else None


def _close_handlers() -> None:
    """Remove Sphinx's log handlers, which would repeat every message in the next build."""
    logger = logging.getLogger("sphinx")
    for handler in list(logger.handlers):
        logger.removeHandler(handler)
