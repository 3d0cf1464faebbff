"""Runs Sphinx on the staged pages, and tells what it finds wrong in an author's words."""

from __future__ import annotations

import logging
import re
import shutil
from collections.abc import Callable, Iterator
from io import StringIO
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.errors import SphinxError

from spinbook.course.course import Course
from spinbook.problem import Problem, Severity, SpinbookError
from spinbook.site.contents import Contents
from spinbook.site.extension import NAME
from spinbook.site.page import HOME, SEARCH

_THEMES = Path(__file__).parent
_WARNING = re.compile(r"^(?P<file>/.*?):(?:(?P<line>\d+):)? (?:WARNING|ERROR|CRITICAL): (?P<what>.*)$")
#: What docutils minds of a line `---` between sections; it is shown as a line all the same.
_NO_MATTER = re.compile(r"[Tt]ransition(s)? (must|are)|(begin|end) with a transition|separate transitions")
_ANSI = re.compile(r"\x1b\[[0-9;]*m")
#: myst-nb counts the lines of each cell from this many times the cell's number.
_LINES_A_CELL = 10_000


def run_sphinx(
    contents: Contents, source: Path, cache: Path, course: Course, on_page: Callable[[str], None]
) -> tuple[Path, list[Problem]]:
    """Make the pages in `cache / "html"` from the staged folder `source`. Returns that folder, and what to fix.

    Pages that have not changed are not made again. Raises SpinbookError if Sphinx can't go on.
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
        # A broken memory of earlier builds is not worth keeping.
        shutil.rmtree(cache / "doctrees", ignore_errors=True)
        words = str(error).strip().splitlines()
        found = f"the pages could not be made: {words[-1] if words else type(error).__name__}"
        fix = "Look at what was changed last." if isinstance(error, SphinxError) else "This is a fault of Spinbook's."
        raise SpinbookError(*_problems(text.getvalue(), contents, source), Problem(source, None, found, fix)) from None
    finally:
        _close_handlers()
    return output, list(_problems(text.getvalue(), contents, source))


def _settings(contents: Contents, course: Course) -> dict[str, Any]:
    terms = [(form, term.anchor) for term in contents.terms for form in term.forms]
    nav = [{"page": page.name, "title": page.title, "kind": page.kind} for page in contents.pages if page.name != HOME]
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
        "myst_heading_anchors": 4,
        "myst_all_links_external": False,
        "html_theme": "theme",
        "html_theme_path": [str(_THEMES)],
        "html_title": course.title,
        "html_math_renderer": "mathml",
        "html_copy_source": False,
        "html_show_sourcelink": False,
        "html_use_index": False,
        "html_permalinks_icon": "#",
        "html_additional_pages": {SEARCH: "search.html"},
        "html_context": {"nav": nav, "repository": course.repository, "site": course.site},
        "spinbook_terms": terms,
        "suppress_warnings": ["misc.highlighting_failure", "myst.xref_missing_ignored"],
    }


def _problems(text: str, contents: Contents, source: Path) -> Iterator[Problem]:
    seen: set[str] = set()
    for line in _ANSI.sub("", text).splitlines():
        match = _WARNING.match(line)
        if match is None or line in seen or _NO_MATTER.search(line):
            continue
        seen.add(line)
        file, number = _place(match.group("file"), match.group("line"), contents, source)
        found = re.sub(r"\s*\[[\w.-]+\]$", "", match.group("what"))
        yield Problem(file, number, found, "The page shows it as well as it can.", Severity.WARNING)


def _place(file: str, line: str | None, contents: Contents, source: Path) -> tuple[Path, int | None]:
    """The author's file and line for a place in a staged page."""
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
    cell, within = divmod(number, _LINES_A_CELL)
    # myst-nb counts a cell's lines from 1, and MyST's parser adds one more.
    return origin, starts[min(cell, len(starts)) - 1] + max(within - 2, 0) if cell else None


def _close_handlers() -> None:
    """Sphinx leaves handlers at its logger, which would speak again at the next build."""
    logger = logging.getLogger("sphinx")
    for handler in list(logger.handlers):
        logger.removeHandler(handler)
