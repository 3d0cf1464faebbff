"""A page runs what the chapter shows in pieces, with the messages that the chapter defines, in a real Chromium."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from browser import Opened, opened
from playwright.sync_api import BrowserContext, expect

from spinbook.browser.files import can_run

pytestmark = pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm")

#: Pyodide starts in a few seconds; on a busy machine, in many.
DEADLINE_MS = 60_000


@pytest.fixture(scope="module")
def shown(reader: BrowserContext, programs: str) -> Iterator[Opened]:
    """The page of one chapter, in which all tests run their cells: Pyodide starts once."""
    with opened(reader, f"{programs}/chapters/pieces.html") as page:
        yield page


def test_a_node_in_pieces_runs_with_the_messages_of_its_chapter(shown: Opened) -> None:
    cell = shown.page.locator(".cell-node")
    cell.get_by_role("button", name="Run counter.py").click()
    expect(cell.get_by_role("log")).to_contain_text("[counter]: counted 7", timeout=DEADLINE_MS)

    shown.page.get_by_role("button", name="Run robot_interfaces/msg/Count.msg").click()
    interface = shown.page.locator(".cell-interface").get_by_role("log")
    expect(interface).to_contain_text("robot_interfaces/msg/Count: ready.", timeout=DEADLINE_MS)

    part = shown.page.locator(".cell-part")
    part.get_by_role("button", name="Run cell 2", exact=True).click()
    expect(shown.page.locator("#said")).to_have_text("cell 2: done", timeout=DEADLINE_MS)

    terminal = shown.page.locator(".cell-shell").first
    terminal.get_by_role("button", name="Run cell 4", exact=True).click()
    expect(terminal.get_by_role("log")).to_contain_text("[counter]: counted 7", timeout=DEADLINE_MS)
    assert shown.violations() == []
    assert shown.faults == []


@pytest.mark.soak
def test_demo_nodes_run_in_a_page(shown: Opened) -> None:
    _, talker, listener = shown.page.locator(".cell-shell").all()
    talker.get_by_role("button", name="Run cell 5", exact=True).click()
    expect(talker.get_by_role("log")).to_contain_text("[talker]: Publishing: 'Hello World: 1'", timeout=DEADLINE_MS)

    listener.get_by_role("button", name="Run cell 6", exact=True).click()
    expect(listener.get_by_role("log")).to_contain_text("[ear]: I heard: [Hello World: ", timeout=DEADLINE_MS)
    assert shown.faults == []
