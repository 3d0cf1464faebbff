"""Every cell of every chapter, run in order in a real Chromium, shows what the executed notebook shows."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import pytest
from browser import opened
from chapter_page import ChapterPage, InChromium
from chapter_run import Result, recorded, run_chapter
from playwright.sync_api import Browser
from small_course import ROOT, served

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

EXPECTED = tomllib.loads(Path(__file__).with_name("differences_in_the_page.toml").read_text(encoding="utf-8"))

#: What differs only because Pyodide's Python is newer than this one.
SAME_PYTHON = {"code-the-wrong-value-may-slip-through"} if sys.version_info >= (3, 12) else set()


CHAPTERS = sorted(file.stem for file in (ROOT / "chapters").glob("[0-9]*.md"))


def unexplained(result: Result, reason: dict[str, Any]) -> list[str]:
    """What differs for another reason than this one."""
    return [note for note in result.differs if not any(re.match(pattern, note) for pattern in reason["notes"])]


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("chapter", CHAPTERS)
def test_a_chapter_shows_in_its_page_what_it_shows_in_its_notebook(
    real_course: Path, browser: Browser, chapter: str
) -> None:
    known = EXPECTED.get(chapter, {})
    notebook = real_course / "executed" / f"{chapter}.ipynb"
    with (
        served(real_course / "site") as address,
        opened(browser, f"{address}/chapters/{chapter}.html") as shown,
    ):
        page = ChapterPage(InChromium(shown.page))
        found = {result.cell: result for result in run_chapter(page, recorded(notebook)) if result.differs}
        assert set(found) == set(known) - SAME_PYTHON, found
        reasons = {cell: EXPECTED["reasons"][known[cell]] for cell in found}
        assert [notes for cell, result in found.items() if (notes := unexplained(result, reasons[cell]))] == []
        assert shown.faults == []
        assert shown.violations() == []
