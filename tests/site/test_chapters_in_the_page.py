"""Every cell of every chapter, run in order in a real Chromium, shows what the executed notebook shows."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from browser import opened
from chapter_run import recorded, run_chapter
from playwright.sync_api import Browser
from small_course import ROOT, served

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

EXPECTED = Path(__file__).with_name("differences_in_the_page.toml")

#: What differs only because Pyodide's Python is newer than this one.
SAME_PYTHON = {"code-the-wrong-value-may-slip-through"} if sys.version_info >= (3, 12) else set()


CHAPTERS = sorted(file.stem for file in (ROOT / "chapters").glob("[0-9]*.md"))


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("chapter", CHAPTERS)
def test_a_chapter_shows_in_its_page_what_it_shows_in_its_notebook(
    real_course: Path, browser: Browser, chapter: str
) -> None:
    known = set(tomllib.loads(EXPECTED.read_text(encoding="utf-8")).get(chapter, {})) - SAME_PYTHON
    notebook = real_course / "executed" / f"{chapter}.ipynb"
    with (
        served(real_course / "site") as address,
        opened(browser, f"{address}/chapters/{chapter}.html") as shown,
    ):
        results = run_chapter(shown.page, recorded(notebook))
        found = {result.cell: result.differs for result in results if result.differs}
        assert set(found) == known, found
        assert shown.faults == []
        assert shown.violations() == []
